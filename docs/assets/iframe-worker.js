// A page that was opened from disk may not start a worker. The search of this site then runs its script in a
// hidden frame instead: the same messages, no thread of its own.
if (location.protocol === "file:") {
  window.IFrameWorker = class extends EventTarget {
    constructor(script) {
      super()
      const waiting = []
      this.postMessage = data => waiting.push(data)
      const frame = document.createElement("iframe")
      frame.hidden = true
      frame.answer = data => this.dispatchEvent(new MessageEvent("message", { data }))
      frame.srcdoc =
        `<!doctype html><script>postMessage = data => frameElement.answer(data)<\/script>` +
        `<script src="${script}"><\/script>`
      frame.addEventListener("load", () => {
        this.postMessage = data => frame.contentWindow.dispatchEvent(new MessageEvent("message", { data }))
        waiting.forEach(this.postMessage)
      })
      document.body.append(frame)
    }
  }
  window.Worker = window.IFrameWorker
}
