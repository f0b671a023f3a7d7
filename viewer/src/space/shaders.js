// Shaders of the surface, its points and lines and the cap of its cut. The light comes from the viewer, so that every side
// is lit, and the part beyond the cut is discarded.

export const SURFACE_VERTEX = `
attribute vec3 tint;
attribute float value;
varying vec3 vTint, vNormal, vEye, vPlace;
varying float vValue;
void main() {
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  vTint = tint;
  vValue = value;
  vNormal = normalMatrix * normal;
  vEye = eye.xyz;
  vPlace = position;
  gl_Position = projectionMatrix * eye;
}`;

// A value below 0 stands for none. Lines of equal value are one pixel wide.
const COLOR_OF_VALUE = `
uniform sampler2D stops;
uniform vec3 plain, missing;
uniform float mode, levels;
vec3 colorOf(vec3 tint, float value) {
  if (mode < 0.5) return plain;
  if (mode < 1.5) return tint;
  if (value < -0.001) return missing;
  vec3 color = texture2D(stops, vec2(clamp(value, 0.0, 1.0) * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb;
  if (levels > 0.0) {
    float at = value * levels;
    float step = fwidth(at);  // where it is constant there is no line
    float off = step > 1e-5 ? abs(fract(at - 0.5) - 0.5) / step : 2.0;
    color = mix(vec3(0.08), color, 0.35 + 0.65 * smoothstep(0.6, 1.4, off));
  }
  return color;
}`;

// The weights of ambient light, light from above, key light, light from the viewer and gloss were chosen by eye.
export const SURFACE_FRAGMENT = `
uniform vec4 cut;
uniform vec3 inside;
uniform float opacity, twoSided, orthographic;
varying vec3 vTint, vNormal, vEye, vPlace;
varying float vValue;
${COLOR_OF_VALUE}
void main() {
  if (dot(cut.xyz, vPlace) > cut.w) discard;
  vec3 toViewer = orthographic > 0.5 ? vec3(0.0, 0.0, 1.0) : normalize(-vEye);
  vec3 n = normalize(vNormal);
  // On a sharp edge the normal of a vertex is that of one side: there the triangle's own counts.
  vec3 facet = cross(dFdx(vEye), dFdy(vEye));  // towards the viewer
  facet = normalize(gl_FrontFacing ? facet : -facet);
  if (twoSided > 0.5 && dot(n, facet) < 0.0) facet = -facet;
  n = normalize(mix(facet, n, smoothstep(0.72, 0.9, dot(n, facet))));
  if (twoSided > 0.5 && dot(n, toViewer) < 0.0) n = -n;
  float facing = dot(n, toViewer);
  if (!gl_FrontFacing && twoSided < 0.5) {
    gl_FragColor = vec4(inside * (0.72 + 0.28 * abs(facing)), opacity);
    return;
  }
  vec3 key = normalize(vec3(-0.35, 0.55, 0.8));
  float light = 0.50 + 0.07 * n.y + 0.36 * max(dot(n, key), 0.0) + 0.10 * max(facing, 0.0);
  float gloss = pow(max(dot(n, normalize(key + toViewer)), 0.0), 40.0);
  gl_FragColor = vec4(min(colorOf(vTint, vValue) * light + vec3(0.07 * gloss), 1.0), opacity);
}`;

// Points are drawn 0.004 half diagonals nearer, so that the surface they lie on does not hide them.
export const POINT_VERTEX = `
attribute vec3 tint;
attribute float value;
uniform float size, perspective;
varying vec3 vTint, vPlace;
varying float vValue;
void main() {
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  eye.xyz += perspective > 0.5 ? -0.004 * normalize(eye.xyz) : vec3(0.0, 0.0, 0.004);
  vTint = tint;
  vValue = value;
  vPlace = position;
  gl_Position = projectionMatrix * eye;
  gl_PointSize = max(perspective > 0.5 ? size / -eye.z : size, 1.0);
}`;

export const POINT_FRAGMENT = `
uniform vec4 cut;
uniform float opacity, rim;
varying vec3 vTint, vPlace;
varying float vValue;
${COLOR_OF_VALUE}
void main() {
  float radius = length(gl_PointCoord - 0.5);
  if (dot(cut.xyz, vPlace) > cut.w || radius > 0.5) discard;
  gl_FragColor = vec4(colorOf(vTint, vValue) * (radius > 0.36 ? rim : 1.0), opacity);
}`;

// Lines are drawn half as far nearer as points.
export const LINE_VERTEX = `
uniform float perspective;
varying vec3 vPlace;
void main() {
  vPlace = position;
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  eye.xyz += perspective > 0.5 ? -0.002 * normalize(eye.xyz) : vec3(0.0, 0.0, 0.002);
  gl_Position = projectionMatrix * eye;
}`;

export const LINE_FRAGMENT = `
uniform vec4 cut;
uniform vec3 color;
uniform float opacity;
varying vec3 vPlace;
void main() {
  if (dot(cut.xyz, vPlace) > cut.w) discard;
  gl_FragColor = vec4(color, opacity);
}`;

export const CAP_VERTEX = `
attribute vec2 place;
varying vec2 vPlace;
void main() {
  vPlace = place;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

// On the cap the function is shown with lines at even steps.
export const CAP_FRAGMENT = `
uniform sampler2D values, stops;
uniform float mode, levels;
uniform vec3 inside;
varying vec2 vPlace;
void main() {
  if (mode < 0.5) { gl_FragColor = vec4(inside, 1.0); return; }
  float value = texture2D(values, vPlace).r;
  vec3 color = texture2D(stops, vec2(clamp(value, 0.0, 1.0) * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb;
  float at = value * levels;
  float step = fwidth(at);
  // Beyond the end of the scale the colour is constant, and has no lines.
  float off = step > 1e-5 && at < levels - 0.5 ? abs(fract(at - 0.5) - 0.5) / step : 2.0;
  gl_FragColor = vec4(mix(color * 0.72, color, smoothstep(0.5, 1.3, off)), 1.0);
}`;

export const COUNT_FRAGMENT = `
uniform vec4 cut;
varying vec3 vPlace;
void main() {
  if (dot(cut.xyz, vPlace) > cut.w) discard;
  gl_FragColor = vec4(0.0);
}`;
export const COUNT_VERTEX = `
varying vec3 vPlace;
void main() {
  vPlace = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;
