"""Babylon.js as a shadow technique: the maps of its ShadowGenerator, and its cascades."""

from browser_engine import OWN_VISIBILITY, BrowserEngine
from gnomon_technique import serve

# What Babylon.js puts in the place of a filter that it does not have for the six faces of a point light.
INSTEAD = {
    "pcf": "Poisson samples",
    "contact_hardening": "Poisson samples",
    "blurred_exponential": "maps without blur",
    "blurred_close_exponential": "maps without blur",
}


class BabylonJs(BrowserEngine):
    title = "Babylon.js"
    page = "page_babylon_js.mjs"

    def module(self):
        return "@babylonjs/core"

    def imports(self):
        return {"@babylonjs/core/": "@babylonjs/core/"}

    def supports(self, scene, light, view):
        shadows = self.settings.shadows
        if light.kind == "point" and shadows in INSTEAD:
            return "unsupported", f"Babylon.js gives point lights {INSTEAD[shadows]} in the place of {shadows}"
        if light.kind != "directional" and shadows == "cascaded":
            return "unsupported", "cascades of Babylon.js are for directional lights"
        return "approximate", OWN_VISIBILITY


serve(BabylonJs)
