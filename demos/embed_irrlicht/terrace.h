// The scene of demos/hello_scene.h for Irrlicht: one object.
#pragma once

#include <irrlicht/irrlicht.h>
#include <cmath>

#include "../hello_scene.h"

// The parts of demos/hello_scene.h, with z mirrored. The two colours of a tile are in the tangent and the binormal.
inline irr::scene::SMeshBufferTangents* terrace() {
    using namespace irr;
    auto* mesh = new scene::SMeshBufferTangents;
    const auto vec = [](glm::vec3 v) { return core::vector3df(v.x, v.y, v.z); };
    for (const Part& part : kParts) {
        const bool flat = part.n.x > 0;
        const auto first = static_cast<u16>(mesh->Vertices.size());
        const u16 count = flat ? 4 : 196;
        for (u16 k = 0; k < count; ++k) {
            const float turn = 0.1308997F * static_cast<float>(k >> 1);
            const glm::vec3 round(std::cos(turn), 0, std::sin(turn)), corner(k & 1, k >> 1, 0);
            glm::vec3 p = part.at + corner.x * part.u + corner.y * part.v, n = glm::normalize(glm::cross(part.u, part.v));
            if (!flat && k < 98) p = part.at + part.u.x * round + part.v * corner.x, n = round;
            if (!flat && k >= 98) p = part.at + part.v + part.u.x * round * corner.x, n = {0, 1, 0};
            mesh->Vertices.push_back(video::S3DVertexTangents({p.x, p.y, -p.z}, vec(n), 0xffffffff,
                                                              {corner.x * part.n.x, corner.y * part.n.y}, vec(part.one), vec(part.other)));
        }
        for (u16 k = 0; k + 2 < count; ++k)
            if (flat || (k != 96 && k != 97))
                for (u16 corner = 0; corner < 3; ++corner) mesh->Indices.push_back(static_cast<u16>(first + k + corner));
    }
    mesh->recalculateBoundingBox();
    return mesh;
}
