uniform mat4 world_view_projection, map_projection;
varying vec4 place;
void main() {
  gl_Position = world_view_projection * gl_Vertex;
  place = map_projection * gl_Vertex;
}
