// Converts points and directions between the world and a solid's frame, and gives the velocity of its wall. Include after
// voxel/motion_params.h.
FN vec3 intoFrame(vec4 x, vec4 y, vec4 z, vec3 p) { return vec3(dot(x.xyz, p) + x.w, dot(y.xyz, p) + y.w, dot(z.xyz, p) + z.w); }
FN vec3 turnInto(vec4 x, vec4 y, vec4 z, vec3 v) { return vec3(dot(x.xyz, v), dot(y.xyz, v), dot(z.xyz, v)); }
FN vec3 turnBack(vec4 x, vec4 y, vec4 z, vec3 v) { return x.xyz * v.x + y.xyz * v.y + z.xyz * v.z; }
// m/s, world: of the solid at the point p (m, world); without the deformation.
FN vec3 rigidVelocity(vec4 velocity, vec4 spin, vec4 origin, vec3 p) { return velocity.xyz + cross(spin.xyz, p - origin.xyz); }
