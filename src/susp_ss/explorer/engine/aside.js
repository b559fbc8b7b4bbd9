// What takes seconds is asked of the engine once more, in a thread of its own, so that nothing that is live waits.

let thread = null, busy = false;

// Answers go to the page's store; a question that comes before the last answer makes it needless.
function aside(state) {
  if (busy) {
    thread.terminate();
    thread = null;
  }
  if (!thread) {
    const text = URL.createObjectURL(new Blob([`(${engine})()`], { type: "text/javascript" }));
    thread = new Worker(text);
    URL.revokeObjectURL(text);
    const answer = (data) => {
      busy = Boolean(data.more);
      dash_clientside.set_props("background", { data });
    };
    thread.onmessage = ({ data }) => answer(data);
    thread.onerror = ({ message }) => answer({ errors: [{ parameter: "", message }] });
  }
  busy = true;
  thread.postMessage(state);
}

if (globalThis.document) (globalThis.dash_clientside ??= {}).engine = { compute, background, metrics, aside };
else globalThis.onmessage = ({ data }) => background(data, (found) => postMessage(found));
