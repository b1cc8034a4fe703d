// The walls of a static field at a point: their normals, distances and surface parameters. Include after voxel/field.h.
#include "shaders/fluid/solids/respond.h"

// The walls at a point: one, or, where walls face each other, up to three. A zero normal means no wall.
STRUCT(Walls) {
    vec3 normalA;
    vec3 normalB;
    vec3 normalC;
    float distanceA;  // m, from the point
    float distanceB;
    float distanceC;
    uint codeA;  // of a grid point on its side: see surfaceOf
    uint codeB;
    uint codeC;
    bool corner;
};

// See packNormal in fluid/voxel/distance_band.h.
FN vec3 unpackNormal(uint code) {
    float x = (TO_FLOAT(code & 16383u) - 8191.0f) * (1.0f / 8191.0f);
    float y = (TO_FLOAT((code >> 14u) & 16383u) - 8191.0f) * (1.0f / 8191.0f);
    float z = 1.0f - max(x, -x) - max(y, -y);
    float fold = max(-z, 0.0f);
    vec3 n = vec3(x + (x < 0.0f ? fold : -fold), y + (y < 0.0f ? fold : -fold), z);
    return n * (1.0f / length(n));
}

// The index of the collider, 0..15, in `surfaces` of VoxelFieldOptions.
FN uint wallSurface(uint code) { return code >> 28u; }

// Friction and restitution of the surface whose index is stored in a grid point's normal; they follow the normals in the buffer.
FN vec2 surfaceOf(GLOBAL(uint, bandNormal) FieldParams f, uint code) {
    uint at = f.surfacesAt + 2u * wallSurface(code);
    return vec2(BITS_FLOAT(bandNormal[at]), BITS_FLOAT(bandNormal[at + 1u]));
}

// Response to all walls, with restitution where `bounces` is 1; velocity that one response adds into another wall is removed in the next
// round.
FN vec3 respondToAll(GLOBAL(uint, bandNormal) FieldParams f, vec3 u, Walls w, float bounces) {
    vec2 surface = surfaceOf(PASS(bandNormal) f, w.codeA);
    vec3 v = respond(u, w.normalA, surface.x, surface.y * bounces);
    surface = surfaceOf(PASS(bandNormal) f, w.codeB);
    v = respond(v, w.normalB, surface.x, surface.y * bounces);
    surface = surfaceOf(PASS(bandNormal) f, w.codeC);
    v = respond(v, w.normalC, surface.x, surface.y * bounces);
    if (w.corner)
        for (int k = 0; k < 4; ++k) v = respond(respond(respond(v, w.normalA, 0.0f, 0.0f), w.normalB, 0.0f, 0.0f), w.normalC, 0.0f, 0.0f);
    return v;
}

// Where walls face each other, the interpolated distance blends them: its gradient points between them, and a particle would follow a
// rounded corner. The grid points of the cell separate the walls: each stores the direction to its nearest triangle, from which the wall is
// extended as a plane. Around an outer edge such planes are nearer to the point than the mesh
// is, and are not counted as walls.
FN Walls wallsAt(GLOBAL(float, bandDistance) GLOBAL(uint, bandNormal) FieldParams f, vec3 p, FieldSample here) {
    Walls w;
    w.normalA = vec3(0.0f, 0.0f, 0.0f);
    w.normalB = w.normalA;
    w.normalC = w.normalA;
    w.distanceA = f.band;
    w.distanceB = f.band;
    w.distanceC = f.band;
    w.codeA = 0u;
    w.codeB = 0u;
    w.codeC = 0u;
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
            // Keeps the nearest wall of each direction, in the order of the grid points.
            if (dot(w.normalA, w.normalA) == 0.0f || dot(w.normalA, n) > 0.9f) {
                if (distance_ < w.distanceA) {
                    w.normalA = n;
                    w.distanceA = distance_;
                    w.codeA = code;
                }
            } else if (dot(w.normalB, w.normalB) == 0.0f || dot(w.normalB, n) > 0.9f) {
                if (distance_ < w.distanceB) {
                    w.normalB = n;
                    w.distanceB = distance_;
                    w.codeB = code;
                }
            } else if (distance_ < w.distanceC) {
                w.normalC = n;
                w.distanceC = distance_;
                w.codeC = code;
            }
        }
    }
    // Blending reduces the distance of the nearest wall by less than half a voxel; a larger difference means that a wall was not found.
    w.corner = dot(w.normalB, w.normalB) > 0.0f && min(min(w.distanceA, w.distanceB), w.distanceC) < here.distance + 0.5f * f.voxel;
    if (!w.corner) {
        w.normalB = vec3(0.0f, 0.0f, 0.0f);
        w.normalC = w.normalB;
        w.normalA = fieldNormal(here);
        w.distanceA = here.distance;
        w.codeA = bandNormal[nearestPoint(f, g)];
    }
    return w;
}
