// Who answers: the server, or where there is none the engine in JavaScript, beside the page that it must not hold up.
"use strict";
window.explorer = window.explorer || {};

explorer.answers = (() => {
  const PATIENCE = 10000; // ms until a live question counts as unanswered.

  async function served(name, question, signal) {
    const headers = { "Content-Type": "application/json" };
    const answer = await fetch(name, { method: "POST", headers, body: JSON.stringify(question), signal });
    if (!answer.ok) throw new Error(answer.statusText);
    return answer.json();
  }

  // A thread for each function of the engine, of which one question at a time is asked.
  function beside(name) {
    const script = `(${explorer.beside})(); onmessage = ({ data }) => postMessage(dash_clientside.engine.${name}(data));`;
    const thread = new Worker(URL.createObjectURL(new Blob([script], { type: "text/javascript" })));
    return (question) =>
      new Promise((answered, failed) => {
        thread.onmessage = ({ data }) => answered(data);
        thread.onerror = ({ message }) => failed(new Error(message));
        thread.postMessage(question);
      });
  }

  // {state, pins} is answered by {found, pins}, all that is shown while sliders move.
  const [live, slowly] = explorer.beside
    ? [beside("answer"), beside("background")]
    : [
        (question) => served("answer", question, AbortSignal.timeout(PATIENCE)),
        (conditions) => served("background", conditions),
      ];

  // ``told`` is what takes seconds, the background of a state's carpet.
  const slow = (state, told) => slowly(state).then(told, () => told({ errors: [{ message: "no answer" }] }));

  return { live, slow };
})();
