// Who answers: the server, or where there is none the engine in JavaScript, beside the page that it must not hold up.
"use strict";
window.explorer = window.explorer || {};

explorer.answers = (() => {
  const PATIENCE = 10000; // ms until a live question counts as unanswered.

  // A question that comes before the last is answered makes that one needless, as the server is told.
  function served(name, patience) {
    let last = new AbortController();
    return (question, told, failed) => {
      last.abort();
      const own = (last = new AbortController());
      const asked = {
        method: "POST",
        headers: { "Content-Type": "application/json" },
        body: JSON.stringify(question),
        signal: patience ? AbortSignal.any([own.signal, AbortSignal.timeout(patience)]) : own.signal,
      };
      const read = (answer) => (answer.ok ? answer.json() : Promise.reject(answer.statusText));
      const unless = (then) => (found) => own.signal.aborted || then(found);
      fetch(name, asked).then(read).then(unless(told), unless(failed));
    };
  }

  // A thread for each kind of question; one that comes before the last is answered makes that one needless.
  function beside(name) {
    const answer = `postMessage(dash_clientside.engine.${name}(data, postMessage))`;
    const script = new Blob([`(${explorer.beside})(); onmessage = ({ data }) => ${answer};`], { type: "text/javascript" });
    const address = URL.createObjectURL(script);
    let [thread, busy] = [null, false];
    return (question, told, failed) => {
      if (busy) thread = thread.terminate();
      thread ??= new Worker(address);
      busy = true;
      thread.onmessage = ({ data }) => ((busy = Boolean(data.more)), told(data));
      thread.onerror = ({ message }) => ((busy = false), failed(message));
      thread.postMessage(question);
    };
  }

  // ``live``: {state, pins} is answered by {found, pins}; ``slow``: a state by the background of its carpet.
  return explorer.beside
    ? { live: beside("answer"), slow: beside("background") }
    : { live: served("answer", PATIENCE), slow: served("background") };
})();
