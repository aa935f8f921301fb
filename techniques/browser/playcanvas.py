"""PlayCanvas as a shadow technique: the maps of its lights."""

from browser_engine import OWN_VISIBILITY, BrowserEngine
from gnomon_technique import serve


class PlayCanvas(BrowserEngine):
    title = "PlayCanvas"
    page = "page_playcanvas.mjs"

    def module(self):
        return "playcanvas"

    def imports(self):
        return {"playcanvas": "playcanvas/build/playcanvas.mjs"}

    def supports(self, scene, light, view):
        shadows = self.settings.shadows
        if light.kind == "point" and shadows in ("pcf5", "vsm"):
            return "unsupported", f"PlayCanvas gives point lights pcf3 in the place of {shadows}"
        if shadows == "pcss" and self.settings.depth_bits == "16":
            return "unsupported", "maps for pcss have 32 bits in PlayCanvas"
        if light.kind != "directional" and self.settings.cascades > 1:
            return "unsupported", "cascades of PlayCanvas are for directional lights"
        return "approximate", OWN_VISIBILITY


serve(PlayCanvas)
