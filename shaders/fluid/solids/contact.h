// Contact of a particle with the static field: it advances until contact, loses the velocity into the wall, slides on with the rest,
// and every segment of its path is traced through the voxels, so that it cannot pass a wall. Include after voxel/field.h and voxel/walk.h.
#define CONTACT_STRETCHES 64   // maximum per step; a particle that needs more stops and continues in the next step
#define CONTACT_SLACK 1.0e-4f  // voxels: a smaller violation of the contact distance is ignored
#define CONTACT_VOXELS 1.735f  // above sqrt(3); slightly below kContactVoxels of fluid/voxel/voxel_field.h, which explains it

#include "shaders/fluid/solids/contact_walls.h"

// The path ended `depth` beyond contact with a wall: the part of it beyond contact responds to the wall.
FN vec3 respondBeyond(vec3 way, vec3 n, float depth, float friction, float bounce) {
    float into = -dot(way, n);
    if (!(into > 0.0f && depth > 0.0f)) return way;
    float share = min(depth / into, 1.0f);
    return way * (1.0f - share) + respond(way * share, n, friction, bounce);
}

// Moves out of a wall by the part of `depth` that `moved` has not covered yet, at most half a voxel.
FN vec3 pushOut(vec3 moved, vec3 n, float depth, float most) { return moved + n * clamp(depth - dot(moved, n), 0.0f, most); }

STRUCT(Slid) {
    vec3 position;  // m
    vec3 velocity;  // m/s
    bool touched;   // false: the path was free; position and velocity must not be changed
};

// The fraction t at which a + d t, in cell coordinates, enters the grid; 2 if it never does.
FN float enterGrid(FieldParams f, vec3 a, vec3 d) {
    vec3 size = vec3(TO_FLOAT(f.sizeX), TO_FLOAT(f.sizeY), TO_FLOAT(f.sizeZ));
    if ((d.x == 0.0f && (a.x < 0.0f || a.x > size.x)) || (d.y == 0.0f && (a.y < 0.0f || a.y > size.y)) ||
        (d.z == 0.0f && (a.z < 0.0f || a.z > size.z)))
        return 2.0f;
    float inX = d.x == 0.0f ? 0.0f : (d.x > 0.0f ? -a.x : size.x - a.x) / d.x;
    float inY = d.y == 0.0f ? 0.0f : (d.y > 0.0f ? -a.y : size.y - a.y) / d.y;
    float inZ = d.z == 0.0f ? 0.0f : (d.z > 0.0f ? -a.z : size.z - a.z) / d.z;
    float outX = d.x == 0.0f ? 2.0f : (d.x > 0.0f ? size.x - a.x : -a.x) / d.x;
    float outY = d.y == 0.0f ? 2.0f : (d.y > 0.0f ? size.y - a.y : -a.y) / d.y;
    float outZ = d.z == 0.0f ? 2.0f : (d.z > 0.0f ? size.z - a.z : -a.z) / d.z;
    float tIn = max(max(inX, inY), max(inZ, 0.0f));
    float tOut = min(min(outX, outY), min(outZ, 1.0f));
    return tIn <= tOut ? tIn : 2.0f;
}

// Requires that `start` touches no set voxel; then the returned position touches none. MOVING: `start` may touch one.
FN Slid slideAlong(GLOBAL(uint, surfaceBits) GLOBAL(float, bandDistance) GLOBAL(uint, bandNormal) FieldParams f, vec3 start, vec3 end,
                   vec3 velocity) {
    Slid s;
    s.position = start;
    s.velocity = velocity;
    s.touched = false;
    vec3 rest = end - start;
    float enters = enterGrid(f, toCells(f, start), rest * f.origin.w);
    if (enters > 1.0f) return s;
    s.position = start + rest * enters;  // the border of the grid contains no part of the mesh: it is padded
    rest = rest * (1.0f - enters);
    FieldSample here = fieldAt(PASS(bandDistance) f, s.position);
#if defined(MOVING)
    // The wall has moved over the particle, or another wall pushed it in: no path is traced; it moves out by half a voxel per step and
    // never further in. Inside a closed mesh, where the sign of the distance is negative, out is through the wall.
    bool within = bandDistance[nearestPoint(f, toCells(f, s.position))] < 0.0f;
    if (within || setVoxelNear(PASS(surfaceBits) f, toCells(f, s.position))) {
        vec3 n = within ? fieldNormal(here) * -1.0f : fieldNormal(here);
        s.position = s.position + n * min(within ? f.contact + here.distance : f.contact - here.distance, 0.5f * f.voxel);
        // Deep inside, where no distance gives a direction, the particle moves with the solid.
        s.velocity = dot(n, n) > 0.0f ? respond(velocity, n, 0.0f, 0.0f) : vec3(0.0f, 0.0f, 0.0f);
        s.touched = true;
        return s;
    }
#endif
    for (int k = 0; k < CONTACT_STRETCHES; ++k) {
        float left = length(rest);
        if (!(left > 0.0f)) break;
        // The free distance, but at least half a voxel: from contact distance that does not reach the wall.
        float share = min(max(here.distance - f.contact, 0.5f * f.voxel) / left, 1.0f);
        vec3 stretch = rest * share;
        vec3 next = s.position + stretch;
        rest = share < 1.0f ? rest - stretch : vec3(0.0f, 0.0f, 0.0f);
        if (share >= 1.0f && !s.touched) next = end;
        FieldSample there = fieldAt(PASS(bandDistance) f, next);
        if (there.distance < f.contact) {
            Walls w = wallsAt(PASS(bandDistance) PASS(bandNormal) f, next, there);
            float depthA = f.contact - w.distanceA;
            float depthB = f.contact - w.distanceB;
            float depthC = f.contact - w.distanceC;
            if (!(depthA > 0.0f)) w.normalA = vec3(0.0f, 0.0f, 0.0f);
            if (!(depthB > 0.0f)) w.normalB = vec3(0.0f, 0.0f, 0.0f);
            if (!(depthC > 0.0f)) w.normalC = vec3(0.0f, 0.0f, 0.0f);
            float fast = -min(min(dot(s.velocity, w.normalA), dot(s.velocity, w.normalB)), dot(s.velocity, w.normalC));
            float bounces = fast > f.restSpeed ? 1.0f : 0.0f;
            vec2 surface = surfaceOf(PASS(bandNormal) f, w.codeA);
            vec3 ended = respondBeyond(stretch, w.normalA, depthA, surface.x, surface.y * bounces);
            surface = surfaceOf(PASS(bandNormal) f, w.codeB);
            ended = respondBeyond(ended, w.normalB, depthB, surface.x, surface.y * bounces);
            surface = surfaceOf(PASS(bandNormal) f, w.codeC);
            ended = respondBeyond(ended, w.normalC, depthC, surface.x, surface.y * bounces);
            vec3 change = ended - stretch;
            if (fast > 0.0f || dot(change, change) > 0.0f) {
                s.touched = true;
                rest = respondToAll(PASS(bandNormal) f, rest, w, bounces);
                s.velocity = respondToAll(PASS(bandNormal) f, s.velocity, w, bounces);
            }
            // Still nearer than the contact distance, because of curvature or from the start. In a corner: out of each wall.
            if (w.corner) {
                for (int r = 0; r < 3; ++r) {
                    change = pushOut(change, w.normalA, depthA, 0.5f * f.voxel);
                    change = pushOut(change, w.normalB, depthB, 0.5f * f.voxel);
                    change = pushOut(change, w.normalC, depthC, 0.5f * f.voxel);
                }
                s.touched = true;
            }
            next = next + change;
            there = fieldAt(PASS(bandDistance) f, next);
            // Else along the gradient, while that increases the distance. Midway between two walls the gradient is short, and so is the
            // correction: in a channel that is too narrow for contact, particles do not oscillate.
            for (int r = 0; r < 2 && !w.corner; ++r) {
                float depth = f.contact - there.distance;
                if (depth < CONTACT_SLACK * f.voxel) break;
                vec3 out_ = fieldNormal(there) * (min(depth, 0.5f * f.voxel) * min(length(there.gradient), 1.0f));
                FieldSample better = fieldAt(PASS(bandDistance) f, next + out_);
                if (!(better.distance > there.distance)) break;
                next = next + out_;
                there = better;
                s.touched = true;
            }
        }
        // A segment inside one voxel whose end is CONTACT_VOXELS from the mesh is inside a voxel that no triangle touches; every other
        // segment is traced.
        vec3 a = toCells(f, s.position);
        vec3 b = toCells(f, next);
        vec3 across = floor(a) - floor(b);
        bool sameVoxel = dot(across, across) == 0.0f && there.distance >= CONTACT_VOXELS * f.voxel;
        if (!sameVoxel && walkVoxels(PASS(surfaceBits) f, a, b) <= 1.0f) {
            s.velocity = vec3(0.0f, 0.0f, 0.0f);
            s.touched = true;
            return s;
        }
        s.position = next;
        here = there;
        if (k == CONTACT_STRETCHES - 1 && dot(rest, rest) > 0.0f) s.touched = true;
    }
    return s;
}
