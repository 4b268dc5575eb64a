#version 460
// The picture in its place in a window, and over it what the window's owner painted.
layout(constant_id = 0) const bool kPicture = false;
layout(constant_id = 1) const bool kSmooth = false;
layout(constant_id = 2) const bool kOverlay = false;

layout(push_constant) uniform Constants {
  vec4 place;       ///< left, top, width, height [pixels of the window]
  vec4 background;
};
uniform sampler2D picture;
uniform sampler2D overlay;  ///< premultiplied alpha, as large as the window

layout(location = 0) out vec4 shown;

void main() {
  vec3 colour = background.rgb;
  if (kPicture) {
    const vec2 at = (gl_FragCoord.xy - place.xy) / place.zw;
    if (all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, vec2(1.0)))) {
      const ivec2 size = textureSize(picture, 0);
      colour = kSmooth ? textureLod(picture, at, 0.0).rgb : texelFetch(picture, min(ivec2(at * vec2(size)), size - 1), 0).rgb;
    }
  }
  if (kOverlay) {
    // While a window is dragged larger, what was painted for its old size is still there.
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    if (all(lessThan(pixel, textureSize(overlay, 0)))) {
      const vec4 over = texelFetch(overlay, pixel, 0);
      colour = over.rgb + colour * (1.0 - over.a);
    }
  }
  shown = vec4(colour, 1.0);
}
