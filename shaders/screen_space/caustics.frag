// A photon's picture: a pyramid, whose sum over the texels is 1. Blended by addition. With BASE those that met no water, each a texel of
// its own.
layout(location = 0) out vec4 colour;
#if defined(BASE)
uniform sampler2D flux;  // w: 0: it met no water
void main() { colour = texelFetch(flux, ivec2(gl_FragCoord.xy), 0).w == 0.0 ? vec4(1.0) : vec4(0.0); }
#else
flat in vec3 light;
flat in vec2 middle;   // texels
flat in float spread;  // texels
void main() {
    vec2 share = max(1.0 - abs(gl_FragCoord.xy - middle) / spread, 0.0);
    colour = vec4(light * (share.x * share.y), 1.0);
}
#endif
