// A model with one of everything that a file can set.
#pragma once

#include <memory>
#include <string>

#include "engine/scene/model.h"

namespace rivulet::whole_model {

inline std::shared_ptr<const Image> imageOf(const std::string& name, int width, int height) {
    auto image = std::make_shared<Image>();
    image->name = name;
    image->width = width;
    image->height = height;
    for (int k = 0; k < 4 * width * height; ++k) image->rgba.push_back(static_cast<uint8_t>(k * 7));
    return image;
}

inline Model everything() {
    Model model;
    model.nodes = {{"root", mat4(1.0F), -1}, {"arm", glm::mat4_cast(glm::quat(0.6F, 0, 0.8F, 0)), 0}, {"hand", mat4(2.0F), 1}};
    const auto picture = imageOf("picture", 5, 3), glow = imageOf("glow", 2, 2);
    for (int p = 0; p < 2; ++p) {
        ModelPart part;
        part.name = p == 0 ? "skin" : "shirt";
        part.mesh.name = "mesh";
        part.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1e14F}};
        part.mesh.normals.assign(4, vec3(0, 1, 0));
        if (p == 0) part.mesh.uvs.assign(4, vec2(0.25F, 0.75F));
        part.mesh.indices = {0, 1, 2, 0, 2, 3};
        part.material.baseColour = vec3(0.1F, 0.2F, 0.3F);
        part.material.emission = vec3(3, 2, 1);
        part.material.blended = p == 1;
        part.material.doubleSided = p == 0;
        part.material.cutoff = 0.25F;
        part.material.colour = picture;
        part.material.normals = p == 0 ? picture : nullptr;
        part.material.glow = p == 1 ? glow : nullptr;
        part.materialName = "cloth";
        part.hasMaterial = true;
        part.node = p + 1;
        part.morphs = {{"smile", {1, 3}, {{0, 0, 0.5F}, {1, 0, 0}}}, {"nothing", {}, {}}};
        part.restWeights = {0.5F, 0};
        part.bones = {{0, mat4(1.0F)}, {2, mat4(0.5F)}};
        part.grips.assign(4, Grip{uvec4(0, 1, 0, 0), vec4(0.75F, 0.25F, 0, 0)});
        model.parts.push_back(part);
    }
    Clip clip;
    clip.name = "wave";
    clip.seconds = 2;
    clip.nodes = {{1, {{0, 1, 2}, {vec3(0), vec3(1), vec3(2)}}, {{0.5}, {glm::quat(0.6F, 0, 0.8F, 0)}}, {}}};
    clip.morphs = {{2, {{0, 2}, {{0, 1}, {1, 0.5F}}}}};
    model.clips = {clip};
    model.cameras = {{"eye", 0, vec3(1, 2, 3), vec3(0, 0, -1), 30}};
    model.lights = {{"sun", 1, vec3(0, -1, 0), vec3(5, 5, 4)}};
    return model;
}

}  // namespace rivulet::whole_model
