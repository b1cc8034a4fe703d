// How a particle meets the static field: it advances until contact, loses what goes into the wall, slides on with the rest,
// and every stretch of its way is walked through the voxels, so that nothing passes. Include after voxel/field.h and voxel/walk.h.
#define CONTACT_STRETCHES 64  // at most, a step; a particle that needs more stops where it got to, and goes on next step
#define CONTACT_SLACK 1.0e-4f // voxels: nearer than contact by less than this is let be

#include "shaders/fluid/respond.h"

// The walls at a point: one, or two where they meet at an angle that holds water. A zero normal is no wall.
STRUCT(Walls) {
    vec3  normalA;
    vec3  normalB;
    float distanceA;  // m
    float distanceB;
};

// Response to both; what the second would push into the first goes along the crease instead.
FN vec3 respondBoth(vec3 u, vec3 a, vec3 b, float friction, float bounce) {
    vec3 v = respond(respond(u, a, friction, bounce), b, friction, bounce);
    if (dot(v, a) < 0.0f && dot(v, v) > 0.0f) {
        vec3 crease = cross(a, b);
        float square = dot(crease, crease);
        v = square > 1.0e-6f ? crease * (dot(v, crease) / square) : vec3(0.0f, 0.0f, 0.0f);
    }
    return v;
}

// Near where two walls meet the interpolated distance blends them: its gradient is shorter than 1 and points between them, and a
// particle would be led round the corner as in a bowl. One voxel ahead and one behind, along the way it slides, the walls are told apart.
FN Walls wallsAt(GLOBAL(float, bandDistance) FieldParams f, vec3 p, FieldSample here, vec3 heading) {
    Walls w;
    w.normalA = fieldNormal(here);
    w.distanceA = here.distance;
    w.normalB = vec3(0.0f, 0.0f, 0.0f);
    w.distanceB = f.band;
    vec3 slide = heading - w.normalA * dot(heading, w.normalA);
    float along = length(slide);
    if (dot(here.gradient, here.gradient) < 0.9f && along > 1.0e-3f * length(heading)) {
        vec3 reach = slide * (f.voxel / along);
        FieldSample ahead = fieldAt(PASS(bandDistance) f, p + reach);
        FieldSample behind = fieldAt(PASS(bandDistance) f, p - reach);
        vec3 aheadNormal = fieldNormal(ahead);
        vec3 behindNormal = fieldNormal(behind);
        float rise = dot(aheadNormal, reach);
        float fall = dot(behindNormal, reach);
        // Only where the walls face each other: round an outer edge the one normal is right.
        if (fall > 0.2f * f.voxel) {
            w.normalB = behindNormal;
            w.distanceB = behind.distance + fall;
        }
        if (rise < -0.2f * f.voxel) {
            if (fall <= 0.2f * f.voxel) {
                w.normalB = w.normalA;
                w.distanceB = w.distanceA;
            }
            w.normalA = aheadNormal;
            w.distanceA = ahead.distance - rise;
        }
    }
    return w;
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

// `start` touches no set voxel; nor does the position returned.
FN Slid slideAlong(GLOBAL(uint, surfaceBits) GLOBAL(float, bandDistance) FieldParams f, vec3 start, vec3 end, vec3 velocity) {
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
    for (int k = 0; k < CONTACT_STRETCHES; ++k) {
        float left = length(rest);
        if (!(left > 0.0f)) break;
        // As far as is free, and half a voxel at least: from contact that is still on the near side of the wall.
        float share = min(max(here.distance - f.contact, 0.5f * f.voxel) / left, 1.0f);
        vec3 stretch = rest * share;
        vec3 heading = rest;
        vec3 next = s.position + stretch;
        rest = share < 1.0f ? rest - stretch : vec3(0.0f, 0.0f, 0.0f);
        if (share >= 1.0f && !s.touched) next = end;
        FieldSample there = fieldAt(PASS(bandDistance) f, next);
        if (there.distance < f.contact) {
            Walls w = wallsAt(PASS(bandDistance) f, next, there, heading);
            float depthA = f.contact - w.distanceA;
            float depthB = f.contact - w.distanceB;
            vec3 a = depthA > 0.0f ? w.normalA : vec3(0.0f, 0.0f, 0.0f);
            vec3 b = depthB > 0.0f ? w.normalB : vec3(0.0f, 0.0f, 0.0f);
            float fast = max(-dot(s.velocity, a), -dot(s.velocity, b));
            float bounce = fast > f.restSpeed ? f.restitution : 0.0f;
            // The share of this stretch that lay beyond contact answers like the way that is left.
            float intoA = -dot(stretch, a);
            float intoB = -dot(stretch, b);
            float beyond = max(intoA > 0.0f ? clamp(depthA / intoA, 0.0f, 1.0f) : 0.0f, intoB > 0.0f ? clamp(depthB / intoB, 0.0f, 1.0f) : 0.0f);
            if (fast > 0.0f || beyond > 0.0f) {
                s.touched = true;
                next = next + respondBoth(stretch * beyond, a, b, f.friction, bounce) - stretch * beyond;
                rest = respondBoth(rest, a, b, f.friction, bounce);
                s.velocity = respondBoth(s.velocity, a, b, f.friction, bounce);
                there = fieldAt(PASS(bandDistance) f, next);
            }
            // Still nearer than contact, by curvature or from the start: out along the gradient, while that helps. Where walls face each
            // other the gradient is short and the push with it, so that in a channel too narrow for contact nothing is thrown to and fro.
            for (int r = 0; r < 2; ++r) {
                float depth = f.contact - there.distance;
                if (depth < CONTACT_SLACK * f.voxel) break;
                float slope = length(there.gradient);
                vec3 out_ = fieldNormal(there) * (min(depth, 0.5f * f.voxel) * min(slope, 1.0f));
                FieldSample better = fieldAt(PASS(bandDistance) f, next + out_);
                if (!(better.distance > there.distance)) break;
                next = next + out_;
                there = better;
                s.touched = true;
            }
        }
        if (walkVoxels(PASS(surfaceBits) f, toCells(f, s.position), toCells(f, next)) <= 1.0f) {
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
