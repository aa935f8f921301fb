# Runs within Godot: takes scene, light and camera as lines of JSON, draws frames and answers each line by one. All is done by
# the VisualServer, without nodes: its calls count at once, those of nodes at the next frame.
extends SceneTree

const SPLITS = {"orthogonal": VisualServer.LIGHT_DIRECTIONAL_SHADOW_ORTHOGONAL,
	"two": VisualServer.LIGHT_DIRECTIONAL_SHADOW_PARALLEL_2_SPLITS,
	"four": VisualServer.LIGHT_DIRECTIONAL_SHADOW_PARALLEL_4_SPLITS}
const RANGES = {"stable": VisualServer.LIGHT_DIRECTIONAL_SHADOW_DEPTH_RANGE_STABLE,
	"optimized": VisualServer.LIGHT_DIRECTIONAL_SHADOW_DEPTH_RANGE_OPTIMIZED}
const WHITE = """shader_type spatial;
render_mode cull_disabled, ambient_light_disabled, specular_disabled;
void fragment() { ALBEDO = vec3(1.0); ROUGHNESS = 1.0; SPECULAR = 0.0; }
void light() { DIFFUSE_LIGHT += ATTENUATION; }"""
const STEEP = 100  # how suddenly a spot ends at its rim

var vs = VisualServer
var scenario = vs.scenario_create()
var material = vs.material_create()
var camera = vs.camera_create()
var view = vs.viewport_create()
var meshes = []
var items = []
var light
var lamp
var kind = ""
var warm = {}

func _init():
	var shader = vs.shader_create()
	vs.shader_set_code(shader, WHITE)
	vs.material_set_shader(material, shader)
	var dark = vs.environment_create()
	vs.environment_set_background(dark, vs.ENV_BG_COLOR)
	vs.environment_set_bg_color(dark, Color(0, 0, 0))
	vs.environment_set_ambient_light(dark, Color(0, 0, 0), 0, 0)
	vs.camera_set_environment(camera, dark)
	vs.viewport_set_active(view, true)
	vs.viewport_set_update_mode(view, vs.VIEWPORT_UPDATE_ALWAYS)
	vs.viewport_set_usage(view, vs.VIEWPORT_USAGE_3D_NO_EFFECTS)
	vs.viewport_set_hdr(view, true)
	vs.viewport_set_scenario(view, scenario)
	vs.viewport_attach_camera(view, camera)
	for k in range(4):  # of the atlas, by default Godot's own
		vs.viewport_set_shadow_atlas_quadrant_subdivision(view, k, [2, 2, 4, 8][k])

# Answers requests until there are no more.
func _idle(_delta):
	while true:
		var lines = []
		OS.execute("/bin/bash", ["exchange.sh", "answer.json"], true, lines)
		if not lines or not lines[0]:
			return true
		var request = JSON.parse(lines[0]).result
		var answer = call(request["do"], request)
		var file = File.new()
		file.open("res://answer.json", File.WRITE)
		file.store_line(JSON.print(answer))
		file.close()

func facts(_request):
	var version = Engine.get_version_info()
	var driver = ["gles3", "gles2"][OS.get_current_video_driver()]
	var numbers = "%d.%d.%d" % [version.major, version.minor, version.patch]
	return {"version": numbers, "gl": vs.get_video_adapter_name(), "driver": driver}

func build(request):
	for rid in items + meshes:
		vs.free_rid(rid)
	items = []
	meshes = []
	warm = {}
	var file = File.new()
	file.open("res://geometry", File.READ)
	for casts in request["casts"]:
		var arrays = []
		arrays.resize(vs.ARRAY_MAX)
		arrays[vs.ARRAY_VERTEX] = file.get_var()
		arrays[vs.ARRAY_NORMAL] = file.get_var()
		var mesh = vs.mesh_create()
		vs.mesh_add_surface_from_arrays(mesh, vs.PRIMITIVE_TRIANGLES, arrays, [], 0)
		var item = vs.instance_create2(mesh, scenario)
		vs.instance_geometry_set_material_override(item, material)
		vs.instance_geometry_set_cast_shadows_setting(item,
			vs.SHADOW_CASTING_SETTING_DOUBLE_SIDED if casts else vs.SHADOW_CASTING_SETTING_OFF)
		meshes.append(mesh)
		items.append(item)
	file.close()
	return {}

func transform_of(w):
	return Transform(Vector3(w[0], w[1], w[2]), Vector3(w[3], w[4], w[5]), Vector3(w[6], w[7], w[8]), Vector3(w[9], w[10], w[11]))

func relight(request):
	if kind:
		vs.free_rid(lamp)
		vs.free_rid(light)
	warm = {}
	kind = request["kind"]
	if kind == "point":
		light = vs.omni_light_create()
	elif kind == "spot":
		light = vs.spot_light_create()
		vs.light_set_param(light, vs.LIGHT_PARAM_SPOT_ANGLE, request["angle"])
		vs.light_set_param(light, vs.LIGHT_PARAM_SPOT_ATTENUATION, STEEP)
	else:
		light = vs.directional_light_create()
	vs.light_set_param(light, vs.LIGHT_PARAM_RANGE, request["reach"])
	vs.light_set_param(light, vs.LIGHT_PARAM_ATTENUATION, 0)
	vs.light_set_param(light, vs.LIGHT_PARAM_SPECULAR, 0)
	lamp = vs.instance_create2(light, scenario)
	vs.instance_set_transform(lamp, transform_of(request["world"]))
	return {}

# Also has Godot draw its maps anew: it keeps them while light and scene are as they were.
func set_shadows(settings, far):
	vs.light_omni_set_shadow_mode(light,
		vs.LIGHT_OMNI_SHADOW_CUBE if settings["around"] == "cube" else vs.LIGHT_OMNI_SHADOW_DUAL_PARABOLOID)
	vs.light_omni_set_shadow_detail(light, vs.LIGHT_OMNI_SHADOW_DETAIL_HORIZONTAL)  # with the other, half of the ground is dark
	vs.light_directional_set_shadow_mode(light, SPLITS[settings["splits"]])
	vs.light_directional_set_blend_splits(light, settings["blend"])
	vs.light_directional_set_shadow_depth_range_mode(light, RANGES[settings["range"]])
	var is_sun = kind == "directional"
	var values = {vs.LIGHT_PARAM_SHADOW_MAX_DISTANCE: far, vs.LIGHT_PARAM_SHADOW_SPLIT_1_OFFSET: settings["split_1"],
		vs.LIGHT_PARAM_SHADOW_SPLIT_2_OFFSET: settings["split_2"], vs.LIGHT_PARAM_SHADOW_SPLIT_3_OFFSET: settings["split_3"],
		vs.LIGHT_PARAM_SHADOW_NORMAL_BIAS: settings["normal_bias"] if is_sun else 0.0,
		vs.LIGHT_PARAM_SHADOW_BIAS_SPLIT_SCALE: settings["split_scale"],
		vs.LIGHT_PARAM_CONTACT_SHADOW_SIZE: settings["contact"],
		vs.LIGHT_PARAM_SHADOW_BIAS: settings["sun_bias"] if is_sun else settings["bias"]}
	for name in values:
		vs.light_set_param(light, name, values[name])

func frame(request):
	var eye = request["camera"]
	vs.camera_set_perspective(camera, eye["fov_y_degrees"], eye["near"], eye["far"])
	vs.camera_set_transform(camera, transform_of(eye["world"]))
	vs.viewport_set_size(view, request["width"], request["height"])
	vs.viewport_set_shadow_atlas_size(view, request["settings"]["map_size"])
	vs.light_set_shadow(light, request["shadows"])
	var texture = vs.viewport_get_texture(view)
	for _k in range(1 if warm.has(request["shadows"]) else 3):  # a first frame of its kind makes programs and textures
		set_shadows(request["settings"], eye["far"])
		vs.force_draw(false)
	warm[request["shadows"]] = true
	vs.texture_get_data(texture)
	set_shadows(request["settings"], eye["far"])
	var start = OS.get_ticks_usec()
	vs.force_draw(false)
	var image = vs.texture_get_data(texture)  # waits for the frame
	var middle = OS.get_ticks_usec()
	vs.texture_get_data(texture)
	var end = OS.get_ticks_usec()
	image.convert(Image.FORMAT_RF)
	var file = File.new()
	file.open("res://picture", File.WRITE)
	file.store_buffer(image.get_data())
	file.close()
	return {"ms": max(0, 2 * middle - start - end) / 1000.0}
