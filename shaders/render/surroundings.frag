// A host's surroundings as an environment map: its first level, each next one, and the light on matte surfaces. See environment.glsl.
#if defined(CUBE)
uniform samplerCube source;
#else
uniform sampler2D source;  // equirectangular
#endif
uniform mat3 toSource;     // of a direction in the world
uniform ivec2 size;        // of what is drawn, texels
uniform int taps;          // in each direction: of a texel that is drawn, so many are read
uniform float level;       // of the source, which is read
layout(location = 0) out vec4 colour;

const float kPi = 3.14159265, kMost = 6.0e4;  // of half floats

vec3 directionOf(vec2 uv) {
    float turn = (uv.x - 0.5) * 2.0 * kPi, up = (uv.y - 0.5) * kPi;
    return vec3(cos(up) * sin(turn), sin(up), -cos(up) * cos(turn));
}
vec3 radiance(vec3 dir) {
    vec3 d = toSource * dir;
#if defined(CUBE)
    vec3 light = textureLod(source, d, level).rgb;
#else
    float edge = 0.5 / float(textureSize(source, int(level)).y);  // no wrap-around at the poles
    vec2 uv = vec2(atan(d.x, -d.z) / (2.0 * kPi) + 0.5, asin(clamp(d.y, -1.0, 1.0)) / kPi + 0.5);
    vec3 light = textureLod(source, vec2(uv.x, clamp(uv.y, edge, 1.0 - edge)), level).rgb;
#endif
    return clamp(light, vec3(0.0), vec3(kMost));
}

void main() {
    vec3 sum = vec3(0.0);
#if defined(MATTE)
    // Spherical harmonic `gl_FragCoord.x`, as environment_map.h's matteLight().
    int harmonic = int(gl_FragCoord.x);
    for (int y = 0; y < taps; ++y)
        for (int x = 0; x < 2 * taps; ++x) {
            vec2 uv = (vec2(x, y) + 0.5) / vec2(2 * taps, taps);
            vec3 d = directionOf(uv);
            float basis[9] = float[9](1.0, d.y, d.z, d.x, d.x * d.y, d.y * d.z, 3.0 * d.z * d.z - 1.0, d.x * d.z, d.x * d.x - d.y * d.y);
            float area = kPi * kPi / float(taps * taps) * cos((uv.y - 0.5) * kPi);
            sum += radiance(d) * (area * basis[harmonic]);
        }
    float share[9] = float[9](1.0, 2.0, 2.0, 2.0, 3.75, 3.75, 0.3125, 3.75, 0.9375);
    sum *= share[harmonic] / (4.0 * kPi);
#elif defined(BLURRED)
    // About the direction, with a Gaussian of a standard deviation of one texel of the source at its equator.
    vec3 dir = directionOf(gl_FragCoord.xy / vec2(size));
    vec3 right = normalize(cross(dir, abs(dir.y) < 0.7 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0))), up = cross(right, dir);
    float step_ = kPi / float(textureSize(source, int(level)).y), weights = 0.0;
    for (int y = -2; y <= 2; ++y)
        for (int x = -2; x <= 2; ++x) {
            float weight = exp(-0.5 * float(x * x + y * y));
            sum += weight * radiance(normalize(dir + step_ * (float(x) * right + float(y) * up)));
            weights += weight;
        }
    sum /= weights;
#else
    for (int y = 0; y < taps; ++y)
        for (int x = 0; x < taps; ++x) {
            vec2 within = (vec2(x, y) + 0.5) / float(taps) - 0.5;
            sum += radiance(directionOf((gl_FragCoord.xy + within) / vec2(size)));
        }
    sum /= float(taps * taps);
#endif
    colour = vec4(sum, 1.0);
}
