// Search without a server. Browsers start no worker for a page that is a file, so that the search box would stay hidden:
// here the worker's script runs in a hidden frame instead. The theme takes such a class under the name IFrameWorker.
"use strict";
class FrameWorker extends EventTarget {
  constructor(url) {
    super();
    this.waiting = []; // messages that come before the script is there
    this.onmessage = null;
    const frame = document.createElement("iframe");
    frame.hidden = true;
    document.body.append(frame);
    this.inside = frame.contentWindow;
    this.inside.postMessage = data => this.tell(this, data);
    this.inside.importScripts = (...urls) => urls.reduce((last, next) => last.then(() => this.load(next)), Promise.resolve());
    this.load(url).then(() => {
      const held = this.waiting;
      this.waiting = null;
      held.forEach(data => this.postMessage(data));
    });
  }
  load(url) {
    const page = this.inside.document, script = page.createElement("script");
    script.src = new URL(url, location.href).href;
    return new Promise((done, failed) => {
      script.onload = done;
      script.onerror = failed;
      page.head.append(script);
    });
  }
  tell(target, data) {
    const message = new MessageEvent("message", { data });
    target.dispatchEvent(message);
    if (target === this && this.onmessage) this.onmessage(message);
  }
  postMessage(data) {
    if (this.waiting) this.waiting.push(data);
    else this.tell(this.inside, data);
  }
  terminate() {
    this.inside.frameElement.remove();
  }
}
if (location.protocol === "file:") window.Worker = window.IFrameWorker = FrameWorker;
