// Who answers: the server, or where there is none the engine in JavaScript, beside the page that it must not hold up.
"use strict";
window.explorer = window.explorer || {};

explorer.answers = (() => {
  const PATIENCE = 10000; // ms until a live question counts as unanswered.

  const served = (name, patience) => async (question) => {
    const answer = await fetch(name, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(question),
      signal: patience && AbortSignal.timeout(patience),
    });
    if (!answer.ok) throw new Error(answer.statusText);
    return answer.json();
  };

  // A worker of its own for each kind of question, of which there is one at a time; what says that there is more to come
  // is a part of the answer.
  function beside(name) {
    const answer = `postMessage(dash_clientside.engine.${name}(data, postMessage))`;
    const script = `(${explorer.beside})(); onmessage = ({ data }) => ${answer};`;
    const worker = new Worker(URL.createObjectURL(new Blob([script], { type: "text/javascript" })));
    return (question, partly) =>
      new Promise((answered, failed) => {
        worker.onmessage = ({ data: { more, ...found } }) => (more ? partly : answered)(found);
        worker.onerror = ({ message }) => failed(new Error(message));
        worker.postMessage(question);
      });
  }

  // {state, pins} is answered by {found, pins}; conditions, a state, by the background of the carpet.
  return explorer.beside
    ? { live: beside("answer"), slow: beside("background") }
    : { live: served("answer", PATIENCE), slow: served("background") };
})();
