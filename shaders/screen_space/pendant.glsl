// A drop that hangs: about its centre line, which leaves the skin along the normal and bends towards the way down, its radius r at the
// share s of its height is r^2 = (1 - s) (x + y s + z s^2 + w s^3). Above the plane of its foot it goes on, into the skin.
struct Pendant {
    vec4 foot;        // xyz m, view; w m, its height
    vec4 axis;        // xyz unit, the skin's normal; w opacity
    vec4 swell;       // m^2
    vec4 lean;        // xyz along the skin, by how much the centre line leans at the tip; w m, the largest radius
    vec3 absorption;  // 1/m
};
#if defined(ROWS)
ROWS(0, pendants)  // in the world: foot, axis, swell, lean, absorption
#endif
const int PENDANT_ROWS = 5;
const float PENDANT_ABOVE = -0.1;  // of its height: where it ends above the foot

vec3 centreLine(Pendant p, float s) { return p.foot.xyz + p.foot.w * (p.axis.xyz * s + p.lean.xyz * (0.5 * s * max(s, 0.0))); }
