// How a particle meets the static field: it advances until contact, loses what goes into the wall, slides on with the rest,
// and every stretch of its way is walked through the voxels, so that nothing passes. Include after voxel/field.h and voxel/walk.h.
#define CONTACT_STRETCHES 64  // at most, a step; a particle that needs more stops where it got to, and goes on next step
#define CONTACT_SLACK 1.0e-4f // voxels: nearer than contact by less than this is let be
#define CONTACT_VOXELS 1.735f // above sqrt(3); a little below kContactVoxels of fluid/voxel/voxel_field.h, which says what it is good for

#include "shaders/fluid/respond.h"

// The walls at a point: one; or, where walls face each other, up to three. A zero normal is no wall.
STRUCT(Walls) {
    vec3  normalA;
    vec3  normalB;
    vec3  normalC;
    float distanceA;  // m, from the point
    float distanceB;
    float distanceC;
    vec2  surfaceA;  // friction, restitution
    vec2  surfaceB;
    vec2  surfaceC;
    bool  corner;
};

// Response to all of them, bouncing where `bounces` is 1; what the answer to one pushes into another goes next time round.
FN vec3 respondToAll(vec3 u, Walls w, float bounces) {
    vec3 v = respond(u, w.normalA, w.surfaceA.x, w.surfaceA.y * bounces);
    v = respond(v, w.normalB, w.surfaceB.x, w.surfaceB.y * bounces);
    v = respond(v, w.normalC, w.surfaceC.x, w.surfaceC.y * bounces);
    if (w.corner)
        for (int k = 0; k < 4; ++k) v = respond(respond(respond(v, w.normalA, 0.0f, 0.0f), w.normalB, 0.0f, 0.0f), w.normalC, 0.0f, 0.0f);
    return v;
}

// See packNormal in fluid/voxel/distance_band.h.
FN vec3 unpackNormal(uint code) {
    float x = (TO_FLOAT(code & 16383u) - 8191.0f) * (1.0f / 8191.0f);
    float y = (TO_FLOAT((code >> 14u) & 16383u) - 8191.0f) * (1.0f / 8191.0f);
    float z = 1.0f - max(x, -x) - max(y, -y);
    float fold = max(-z, 0.0f);
    vec3 n = vec3(x + (x < 0.0f ? fold : -fold), y + (y < 0.0f ? fold : -fold), z);
    return n * (1.0f / length(n));
}

// Which collider's wall it is, 0..15: the `surfaces` of VoxelFieldOptions.
FN uint wallSurface(uint code) {
    return code >> 28u;
}

// The index of the grid point nearest to `g`, cell coordinates; of the grid's border where `g` is beyond it.
FN uint nearestPoint(FieldParams f, vec3 g) {
    uint x = TO_UINT(clamp(g.x + 0.5f, 0.0f, TO_FLOAT(f.sizeX)));
    uint y = TO_UINT(clamp(g.y + 0.5f, 0.0f, TO_FLOAT(f.sizeY)));
    uint z = TO_UINT(clamp(g.z + 0.5f, 0.0f, TO_FLOAT(f.sizeZ)));
    return (z * (TO_UINT(f.sizeY) + 1u) + y) * (TO_UINT(f.sizeX) + 1u) + x;
}

// What lies behind the distances of the surface that a grid point's normal names: friction and restitution.
FN vec2 surfaceOf(GLOBAL(uint, bandNormal) FieldParams f, uint code) {
    uint at = f.surfacesAt + 2u * wallSurface(code);
    return vec2(BITS_FLOAT(bandNormal[at]), BITS_FLOAT(bandNormal[at + 1u]));
}

// Near where walls face each other the interpolated distance blends them: its gradient points between them, and a particle would be
// led round the corner as in a bowl. The cell's own grid points tell the walls apart: each knows the direction to its nearest
// triangle. From there the wall is extended as a plane. Round an outer edge such planes come nearer to the point than the mesh
// is, and are not walls.
FN Walls wallsAt(GLOBAL(float, bandDistance) GLOBAL(uint, bandNormal) FieldParams f, vec3 p, FieldSample here) {
    Walls w;
    w.normalA = vec3(0.0f, 0.0f, 0.0f);
    w.normalB = w.normalA;
    w.normalC = w.normalA;
    w.distanceA = f.band;
    w.distanceB = f.band;
    w.distanceC = f.band;
    w.surfaceA = vec2(0.0f, 0.0f);
    w.surfaceB = w.surfaceA;
    w.surfaceC = w.surfaceA;
    vec3 g = toCells(f, p);
    if (!loneWall(here)) {
        int cx = clamp(TO_INT(floor(g.x)), 0, f.sizeX - 1);
        int cy = clamp(TO_INT(floor(g.y)), 0, f.sizeY - 1);
        int cz = clamp(TO_INT(floor(g.z)), 0, f.sizeZ - 1);
        for (int k = 0; k < 8; ++k) {
            int x = cx + (k & 1);
            int y = cy + ((k >> 1) & 1);
            int z = cz + (k >> 2);
            uint at = (TO_UINT(z) * (TO_UINT(f.sizeY) + 1u) + TO_UINT(y)) * (TO_UINT(f.sizeX) + 1u) + TO_UINT(x);
            float there = abs(bandDistance[at]);
            uint code = bandNormal[at];
            vec3 n = unpackNormal(code);
            float distance_ = there + dot(n, g - vec3(TO_FLOAT(x), TO_FLOAT(y), TO_FLOAT(z))) * f.voxel;
            if (there >= f.band || distance_ < here.distance - 0.02f * f.voxel) continue;
            // The nearest of each direction, in the order they come.
            if (dot(w.normalA, w.normalA) == 0.0f || dot(w.normalA, n) > 0.9f) {
                if (distance_ < w.distanceA) {
                    w.normalA = n;
                    w.distanceA = distance_;
                    w.surfaceA = surfaceOf(PASS(bandNormal) f, code);
                }
            } else if (dot(w.normalB, w.normalB) == 0.0f || dot(w.normalB, n) > 0.9f) {
                if (distance_ < w.distanceB) {
                    w.normalB = n;
                    w.distanceB = distance_;
                    w.surfaceB = surfaceOf(PASS(bandNormal) f, code);
                }
            } else if (distance_ < w.distanceC) {
                w.normalC = n;
                w.distanceC = distance_;
                w.surfaceC = surfaceOf(PASS(bandNormal) f, code);
            }
        }
    }
    // Blending takes less than half a voxel off the distance of the nearest; if more is missing, there is a wall that was not found.
    w.corner = dot(w.normalB, w.normalB) > 0.0f && min(min(w.distanceA, w.distanceB), w.distanceC) < here.distance + 0.5f * f.voxel;
    if (!w.corner) {
        w.normalB = vec3(0.0f, 0.0f, 0.0f);
        w.normalC = w.normalB;
        w.normalA = fieldNormal(here);
        w.distanceA = here.distance;
        w.surfaceA = surfaceOf(PASS(bandNormal) f, bandNormal[nearestPoint(f, g)]);
    }
    return w;
}

// A way that ended `depth` beyond contact with a wall: the share of it that lay beyond answers to the wall.
FN vec3 respondBeyond(vec3 way, vec3 n, float depth, float friction, float bounce) {
    float into = -dot(way, n);
    if (!(into > 0.0f && depth > 0.0f)) return way;
    float share = min(depth / into, 1.0f);
    return way * (1.0f - share) + respond(way * share, n, friction, bounce);
}

// Out of a wall that `moved` has not yet left by `depth`, half a voxel at most.
FN vec3 pushOut(vec3 moved, vec3 n, float depth, float most) {
    return moved + n * clamp(depth - dot(moved, n), 0.0f, most);
}

STRUCT(Slid) {
    vec3 position;  // m
    vec3 velocity;  // m/s
    bool touched;   // false: the way was free, position and velocity are to be left as they were
};

// The fraction of the way at which a + d t, in cell coordinates, first is inside the grid; 2 if it never is.
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

// `start` touches no set voxel; nor does the position returned. MOVING: unless it did at the start.
FN Slid slideAlong(GLOBAL(uint, surfaceBits) GLOBAL(float, bandDistance) GLOBAL(uint, bandNormal) FieldParams f, vec3 start, vec3 end, vec3 velocity) {
    Slid s;
    s.position = start;
    s.velocity = velocity;
    s.touched = false;
    vec3 rest = end - start;
    float enters = enterGrid(f, toCells(f, start), rest * f.origin.w);
    if (enters > 1.0f) return s;
    s.position = start + rest * enters;  // the grid's border is free of the mesh: it is padded
    rest = rest * (1.0f - enters);
    FieldSample here = fieldAt(PASS(bandDistance) f, s.position);
#if defined(MOVING)
    // Overrun by its wall, or squeezed into it by another: no way is walked; out, half a voxel a step, and no further in. Within a closed
    // mesh, where the sign says so, out is through the wall.
    bool within = bandDistance[nearestPoint(f, toCells(f, s.position))] < 0.0f;
    if (within || setVoxelNear(PASS(surfaceBits) f, toCells(f, s.position))) {
        vec3 n = within ? fieldNormal(here) * -1.0f : fieldNormal(here);
        s.position = s.position + n * min(within ? f.contact + here.distance : f.contact - here.distance, 0.5f * f.voxel);
        // Deep within, where no distance says which way is out, it goes with the solid.
        s.velocity = dot(n, n) > 0.0f ? respond(velocity, n, 0.0f, 0.0f) : vec3(0.0f, 0.0f, 0.0f);
        s.touched = true;
        return s;
    }
#endif
    for (int k = 0; k < CONTACT_STRETCHES; ++k) {
        float left = length(rest);
        if (!(left > 0.0f)) break;
        // As far as is free, and half a voxel at least: from contact that is still on the near side of the wall.
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
            vec3 ended = respondBeyond(stretch, w.normalA, depthA, w.surfaceA.x, w.surfaceA.y * bounces);
            ended = respondBeyond(ended, w.normalB, depthB, w.surfaceB.x, w.surfaceB.y * bounces);
            ended = respondBeyond(ended, w.normalC, depthC, w.surfaceC.x, w.surfaceC.y * bounces);
            vec3 change = ended - stretch;
            if (fast > 0.0f || dot(change, change) > 0.0f) {
                s.touched = true;
                rest = respondToAll(rest, w, bounces);
                s.velocity = respondToAll(s.velocity, w, bounces);
            }
            // Still nearer than contact, by curvature or from the start. In a corner: out of each wall.
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
            // Else along the gradient, while that helps. Midway between two walls the gradient is short and the push with it, so that in
            // a channel too narrow for contact nothing is thrown to and fro.
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
        // A stretch within one voxel whose end is CONTACT_VOXELS from the mesh is within a voxel that no triangle touches; any other is walked.
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
