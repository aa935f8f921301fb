// OGRE's matrix takes x and y to 0 .. 1 and leaves z as it is in clip space, -1 .. 1. Lit where the map does not reach.
uniform sampler2DShadow map;
varying vec4 place;
void main() {
  vec3 texel = vec3(place.xy / place.w, 0.5 * place.z / place.w + 0.5);
  bool is_inside = place.w > 0.0 && all(equal(texel, clamp(texel, 0.0, 1.0)));
  gl_FragColor = vec4(vec3(is_inside ? shadow2D(map, texel).r : 1.0), 1.0);
}
