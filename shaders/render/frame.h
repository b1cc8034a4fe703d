// The parameters of a frame for all render passes: uniform block 0. Layout shared by C++ and GLSL (std140): vec4 and mat4 only.
#if defined(__cplusplus)
#pragma once
#endif
#include "shaders/common/lang.h"
#if defined(__cplusplus)
namespace rivulet {
#endif
STRUCT(FrameParams) {
    mat4 view;              // world -> view
    mat4 projection;        // view -> clip
    mat4 viewProjection;    // world -> clip
    mat4 inverseView;       // view -> world
    mat4 shadowProjection;  // world -> clip of the meshes' shadow map
    mat4 waterProjection;   // world -> clip of the light's map of the water
    vec4 cameraPos;         // m, world; w = time, s
    vec4 viewport;          // width, height (pixels), 1/width, 1/height
    vec4 ray;               // slope (x, y a metre of depth) of pixel p's line of sight: p * ray.xy + ray.zw; orthographic: its x, y, m
    vec4 planes;            // near, far (m), projection[2][2], projection[3][2]
    vec4 lightDir;          // unit, world, towards the light
    vec4 lightColour;       // linear radiance
    vec4 horizon;           // linear radiance of the sky at the horizon; w = side of the floor's tiles, m, 0 without
    vec4 zenith;            // linear radiance of the sky overhead
    vec4 floorColour;       // reflectance; w = height, m
    vec4 floorFade;         // x, z of the centre (m), radius where the floor begins to fade into the horizon (m), 1 if there is a floor
    vec4 boxTowards[3];     // softboxes: unit direction, world; w = half width / distance
    vec4 boxSide[3];        // unit; w = half height / distance
    vec4 boxRadiance[3];    // w: matte light of radiance 1, 0: the box is only reflected
    vec4 matteLight[9];     // of an environment map, see environment_map.h
    // 1 if the meshes' map was drawn; 1 if the water's was, 2 if it holds light; metres a unit of the first map's depth, of the second's.
    vec4 shadow;
    // With HOST_LIGHT, of a host's scene: x lights, y 1 if its shadow map is there, z the map's bias, w -1 if its depth is reversed,
    // else 1.
    vec4 host;
    vec4 hostLights[8];   // unit, world, towards each light; the first is lightDir
    vec4 hostColours[8];  // linear radiance
    mat4 hostShadow;      // world -> coordinates and depth of the shadow map, as stored
    vec4 fog;             // x 0: none, 1 exponential, 2 its square, 3 linear; y density, 1/m; z, w where linear fog starts, ends, m
    vec4 fogColour;       // as it is mixed
    vec4 fogWay;          // x 1: distances are along the view axis; y 1: it is mixed in display values
};
#if defined(__cplusplus)
static_assert(sizeof(FrameParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
