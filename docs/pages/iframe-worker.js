// A browser starts no worker for pages from the disk: the search runs in a frame there.
if (location.protocol === "file:") {
  window.Worker = class {
    constructor(url) {
      const frame = Object.assign(document.createElement("iframe"), { hidden: true });
      const started = new Promise((done) => {
        frame.onload = () => {
          const inside = frame.contentWindow;
          inside.postMessage = (data) => this.onmessage?.({ data });
          const script = inside.document.createElement("script");
          Object.assign(script, { src: url, onload: () => done(inside) });
          inside.document.body.append(script);
        };
      });
      this.postMessage = (data) => started.then((inside) => inside.onmessage({ data }));
      this.terminate = () => frame.remove();
      document.body.append(frame);
    }
  };
}
