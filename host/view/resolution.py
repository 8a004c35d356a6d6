"""The resolution of the page: less where the browser draws without a GPU, so that the view holds its rate there too."""
SOFTWARE_PIXELS = 1e5  # of a window that is drawn by software

# Runs in the browser. The page reads its parameter fixedDpr, pixels drawn per pixel of the window, when it is loaded.
# Whoever gives it decides.
SCRIPT = """
const gl = document.createElement("canvas").getContext("webgl");
const names = gl && gl.getExtension("WEBGL_debug_renderer_info");
const renderer = names ? gl.getParameter(names.UNMASKED_RENDERER_WEBGL) : "";
const address = new URL(window.location.href);
if (/swiftshader|llvmpipe|softpipe|software|basic render/i.test(renderer) && !address.searchParams.has("fixedDpr")) {
  const scale = Math.min(1, Math.sqrt(%d / (window.innerWidth * window.innerHeight)));
  address.searchParams.set("fixedDpr", scale.toFixed(2));
  window.location.replace(address);
}
""" % SOFTWARE_PIXELS


def adapt(server):
    """Makes each page of a viser server that has no GPU load itself again, once, with SOFTWARE_PIXELS."""
    from viser import _messages  # the library, pinned in host/setup, runs scripts only for its plots
    server.gui._websock_interface.queue_message(_messages.RunJavascriptMessage(source=SCRIPT))
