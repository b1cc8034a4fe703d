// The scene of demos/hello_scene.h for OGRE: one object, its material, and a material that copies a texture.
#pragma once

#include <Ogre.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "../hello_scene.h"

inline void addMaterial(const char* name, const char* vertex, const char* fragment) {
    Ogre::Pass& pass = *Ogre::MaterialManager::getSingleton().create(name, "General")->getTechnique(0)->getPass(0);
    for (const bool first : {true, false}) {
        const auto program = Ogre::HighLevelGpuProgramManager::getSingleton().createProgram(
            std::string(name) + (first ? "V" : "F"), "General", "glsl", first ? Ogre::GPT_VERTEX_PROGRAM : Ogre::GPT_FRAGMENT_PROGRAM);
        program->setSource(first ? vertex : fragment);
        first ? pass.setVertexProgram(program->getName()) : pass.setFragmentProgram(program->getName());
    }
    pass.getVertexProgramParameters()->setNamedAutoConstant("clip", Ogre::GpuProgramParameters::ACT_WORLDVIEWPROJ_MATRIX);
    pass.setCullingMode(Ogre::CULL_NONE);
}

inline void addMaterials() {
    addMaterial("terrace", R"(#version 330
uniform mat4 clip; in vec4 vertex; in vec3 normal; in vec2 uv0; in vec3 uv1, uv2; out vec3 n; out vec2 tile; flat out vec3 one, other;
void main() { n = normal; tile = uv0; one = uv1; other = uv2; gl_Position = clip * vertex; })",
                (std::string("#version 330\nflat in vec3 one, other; in vec3 n; in vec2 tile; out vec4 colour;\n#define normal n\n") +
                 std::strchr(std::strstr(kFragment, "out vec4 colour;"), '\n'))
                    .c_str());
    addMaterial("copy",
                "#version 330\nuniform mat4 clip; in vec4 vertex; out vec2 at;\n"
                "void main() { gl_Position = clip * vertex; at = vec2(sign(vertex.x), -sign(vertex.y)) * 0.5 + 0.5; }",
                "#version 330\nuniform sampler2D from; in vec2 at; out vec4 colour; void main() { colour = texture(from, at); }");
}

// The parts of demos/hello_scene.h, coloured by its fragment shader.
inline Ogre::ManualObject* terrace(Ogre::SceneManager& scene) {
    Ogre::ManualObject* all = scene.createManualObject();
    all->begin("terrace", Ogre::RenderOperation::OT_TRIANGLE_LIST);
    uint32_t first = 0;
    for (const Part& part : kParts) {
        const bool flat = part.n.x > 0;
        const uint32_t count = flat ? 4 : 196;
        for (uint32_t k = 0; k < count; ++k) {
            const float turn = 0.1308997F * static_cast<float>(k >> 1);
            const glm::vec3 round(std::cos(turn), 0, std::sin(turn)), corner(k & 1U, k >> 1, 0);
            glm::vec3 p = part.at + corner.x * part.u + corner.y * part.v, n = glm::normalize(glm::cross(part.u, part.v));
            if (!flat && k < 98) p = part.at + part.u.x * round + part.v * corner.x, n = round;
            if (!flat && k >= 98) p = part.at + part.v + part.u.x * round * corner.x, n = {0, 1, 0};
            all->position(p.x, p.y, p.z);
            all->normal(n.x, n.y, n.z);
            all->textureCoord(corner.x * part.n.x, corner.y * part.n.y);
            all->textureCoord(part.one.x, part.one.y, part.one.z);
            all->textureCoord(part.other.x, part.other.y, part.other.z);
        }
        for (uint32_t k = 0; k + 2 < count; ++k)
            if (flat || (k != 96 && k != 97)) all->triangle(first + k, first + k + 1, first + k + 2);
        first += count;
    }
    all->end();
    return all;
}
