"""The live explorer: a page in the browser on which every slider moves the whole engine.

``state`` says what a page may set, ``compute`` and ``background`` what it shows, ``app`` serves both.
"""
