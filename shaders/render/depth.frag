#if defined(HOLES)
in vec2 posUv;
uniform sampler2D colourMap;
uniform float opacity;
uniform float cutoff;
#endif
void main() {
#if defined(HOLES)
    if (texture(colourMap, posUv).a * opacity < cutoff) discard;
#endif
}
