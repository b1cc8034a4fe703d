#include "engine/render/passes.h"

#include <rivulet_glad/gl.h>
#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <string>
#include <tuple>

#include "engine/render/skin_tables.h"

namespace rivulet {
namespace {

using gpu::BufferHandle;
using gpu::Format;
using gpu::FrameGraph;
using gpu::PassContext;
using gpu::Program;
using gpu::TextureDesc;
using gpu::TextureHandle;
using gpu::Usage;

constexpr int kShadowSize = 1024;     // texels, of the depth map
constexpr int kShadowSharpReach = 2;  // texels either side
constexpr int kShadowSoftReach = 9;   // of the soft map, a quarter as wide
constexpr int kPoseUnit = 4;          // beyond the textures of plain meshes
constexpr float kExposure = 0.55F;
constexpr float kBoxWidth = 1.2F;                        // pixels
const float kPoreTiles = std::round(0.36F / kPoreTile);  // a unit of uv: about 0.36 m where a head's chart fills the tile
const vec4 kBoxColour(0.10F, 0.13F, 0.16F, 0.35F);

TextureDesc sized(const FrameView& view, Format format, int divide = 1) {
    return {.width = (view.width + divide - 1) / divide, .height = (view.height + divide - 1) / divide, .format = format};
}

void bindFrame(const PassContext& c, BufferHandle frame) { glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(frame)); }

void bindShadow(Program& program, const PassContext& c, const LightMaps& light, int unit) {
    program.texture("shadowSharp", unit, c.texture(light.sharp));
    program.texture("shadowSoft", unit + 1, c.texture(light.soft));
}

void bindLight(Program& program, const PassContext& c, const LightMaps& light, int unit) {
    bindShadow(program, c, light, unit);
    program.texture("waterLight", unit + 2, c.texture(light.water));
    program.set("waterAbsorption", light.absorption);
}

// Whether the material has emission or an occlusion map.
bool glows(const Material& m) { return m.emission != vec3(0.0F) || m.occlusion; }

bool isSolid(const Material& m) { return !m.blended && m.cutoff <= 0; }

// Sets back-face culling by the material; a mirroring transform reverses the orientation of triangles.
void cull(const DrawnMesh& m) {
    if (m.material.doubleSided) {
        glDisable(GL_CULL_FACE);
        return;
    }
    glEnable(GL_CULL_FACE);
    glFrontFace(glm::determinant(mat3(m.toWorld)) < 0 ? GL_CW : GL_CCW);
}

// The transform of a plain mesh, for its vertex shader.
void setTransform(Program& p, const DrawnMesh& m) {
    if (m.pose) {
        p.set("poseRows", kPoseUnit);
        p.set("poseTexel", m.pose->texel);
        glBindTextureUnit(kPoseUnit, m.pose->rows);
    }
    p.set("toWorldMatrix", m.pose ? m.pose->toBody : m.toWorld);
}

void setPlace(Program& p, const DrawnMesh& m) {
    setTransform(p, m);
    p.set("normalMatrix", glm::transpose(glm::inverse(mat3(m.pose ? m.pose->toBody : m.toWorld))));
    p.set("baseColour", m.material.baseColour);
    p.set("roughness", m.material.roughness);
    p.set("metallic", m.material.metallic);
}

void setSkin(Program& p, const SkinLook& skin, const MaterialTextures& textures) {
    p.set("scatterLength", glm::max(skin.scatter, vec3(1e-5F)));
    p.set("skinAmount", vec2(skin.translucency, skin.pores));
    p.set("poreTiling", kPoreTiles);
    p.texture("reliefMap", 8, *textures.relief);
    p.texture("regionsMap", 9, *textures.regions);
    p.texture("flushMap", 15, *textures.flushes);
    p.texture("poresMap", 10, *textures.pores);
    p.texture("diffusionMap", 11, *textures.diffusion);
}

void setEye(Program& p, const EyeLook& eye, const MaterialTextures& textures, const mat4& toWorld) {
    const vec3 z = glm::normalize(eye.sight), x = glm::normalize(glm::cross(vec3(0, 1, 0.001F), z)), y = glm::cross(z, x);
    const mat4 fromEye = toWorld * mat4(vec4(x, 0) * eye.radius, vec4(y, 0) * eye.radius, vec4(z, 0) * eye.radius, vec4(eye.centre, 1));
    p.set("toEyeMatrix", glm::inverse(fromEye));
    p.set("cornea", vec4(eye.corneaCentre, eye.corneaRadius, eye.irisPlane, eye.irisRadius));
    p.texture("diffusionMap", 11, *textures.diffusion);
}

void setWet(Program& p, const DrawnMesh& m) {
    if (!m.wet) return;
    p.set("wetFromWorld", m.wet->fromWorld);
    p.set("wetSize", m.wet->size);
    p.set("wetFirstCell", m.wet->firstCell);
    p.set("porosity", m.material.porosity);
}

void drawPart(const DrawnMesh& m, Program& p, const Layer* layer) {
    setPlace(p, m);
    p.set("scale", std::cbrt(std::abs(glm::determinant(mat3(m.toWorld)))));
    p.set("opacity", m.material.opacity);
    p.set("flush", m.material.flush);
    p.set("cutoff", m.material.cutoff);
    p.set("strand", vec2(m.material.strand, static_cast<float>(m.material.strands)));
    auto lod = [](const gpu::Texture* map) { return std::log2(static_cast<float>(std::max(map->width(), map->height()))); };
    p.set("mapLod",
          vec4(lod(m.textures.colour), lod(m.textures.relief), lod(m.textures.regions), lod(m.textures.pores) + std::log2(kPoreTiles)));
    p.texture("colourMap", 4, *m.textures.colour);
    p.texture("roughnessMap", 5, *m.textures.metallicRoughness);
    p.texture("normalMap", 6, *m.textures.normals);
    if (glows(m.material)) {
        p.set("emission", m.material.emission);
        p.texture("occlusionMap", 13, *m.textures.occlusion);
        p.texture("glowMap", 14, *m.textures.glow);
    }
    if (m.material.skin)
        setSkin(p, *m.material.skin, m.textures);
    else if (m.material.eye)
        setEye(p, *m.material.eye, m.textures, m.toWorld);
    if (layer == nullptr) setWet(p, m);
    if (layer != nullptr) {
        const LayerLook& look = layer->look;
        p.texture("layerMap", 7, *layer->texels);
        p.set("layerLook", vec4(look.refractiveIndex, look.roughness, look.filmRoughness, look.darkening));
        p.set("layerAbsorption", vec4(look.absorption, look.scale));
    }
    cull(m);
    m.mesh->draw();
}

}  // namespace

std::vector<Program*> RenderPrograms::all() {
    std::vector<Program*> programs = {&shadowHoles, &shadowFirst, &shadowHalve, &shadowBlur, &floorDepth,   &occlusion, &occlusionBlur,
                                      &sky,         &floor,       &glass,       &box,        &boxOverWater, &tonemap,   &antialias};
    for (Plain* of : {&plain, posed ? &*posed : nullptr})
        if (of != nullptr) programs.insert(programs.end(), {&of->shadow, &of->depth, &of->mesh, &of->meshWet});
    for (auto& [key, program] : parts_) programs.push_back(&program);
    return programs;
}

Result<RenderPrograms::Plain> RenderPrograms::makePlain(const ShaderFiles& files, std::vector<Define> defines) {
    Plain p;
    for (const auto& [into, vertex, fragment] : {std::tuple(&p.shadow, "render/mesh_depth.vert", "render/depth.frag"),
                                                 {&p.depth, "material/mesh.vert", "render/depth.frag"},
                                                 {&p.mesh, "material/mesh.vert", "material/mesh.frag"},
                                                 {&p.meshWet, "material/mesh.vert", "material/mesh.frag"}}) {
        if (into == &p.meshWet) defines.push_back({"WET", "1"});
        Result<Program> made = Program::create(files, {std::string("shaders/") + vertex, std::string("shaders/") + fragment}, defines);
        if (!made) return made.error();
        *into = std::move(*made);
    }
    return p;
}

Status RenderPrograms::preparePosed() {
    if (posed) return ok();
    Result<Plain> made = makePlain(files_, {{"POSED", "1"}});
    if (!made) return made.error();
    posed = std::move(*made);
    return ok();
}

RenderPrograms::Plain& RenderPrograms::of(const DrawnMesh& mesh) { return mesh.pose ? *posed : plain; }

Result<RenderPrograms> RenderPrograms::create(const ShaderFiles& files) {
    RenderPrograms p;
    p.files_ = files;
    Result<Plain> plain = makePlain(files, {});
    if (!plain) return plain.error();
    p.plain = std::move(*plain);
    const std::string full = "shaders/render/fullscreen.vert", box = "shaders/render/box.vert", folder = "shaders/render/";
    std::pair<Program*, Result<Program>> made[] = {
        {&p.shadowHoles, Program::create(files, {folder + "mesh_depth.vert", folder + "depth.frag"}, {{"HOLES", "1"}})},
        {&p.shadowFirst, Program::create(files, {full, folder + "shadow_blur.frag"}, {{"FROM_DEPTH", "1"}})},
        {&p.shadowHalve, Program::create(files, {full, folder + "shadow_blur.frag"}, {{"FROM_DEPTH", "1"}, {"HALVE", "1"}})},
        {&p.shadowBlur, Program::create(files, {full, folder + "shadow_blur.frag"})},
        {&p.floorDepth, Program::create(files, {full, folder + "background_depth.frag"})},
        {&p.occlusion, Program::create(files, {full, folder + "occlusion.frag"})},
        {&p.occlusionBlur, Program::create(files, {full, folder + "occlusion_blur.frag"})},
        {&p.sky, Program::create(files, {full, folder + "background.frag"})},
        {&p.floor, Program::create(files, {full, folder + "background.frag"}, {{"FLOOR", "1"}})},
        {&p.glass, Program::create(files, {"shaders/material/mesh.vert", "shaders/material/glass.frag"})},
        {&p.box, Program::create(files, {box, folder + "box.frag"})},
        {&p.boxOverWater, Program::create(files, {box, folder + "box.frag"}, {{"OVER_WATER", "1"}})},
        {&p.tonemap, Program::create(files, {full, folder + "tonemap.frag"})},
        {&p.antialias, Program::create(files, {full, folder + "antialias.frag"})},
    };
    for (auto& [into, program] : made) {
        if (!program) return program.error();
        *into = std::move(*program);
    }
    return p;
}

Result<Program*> RenderPrograms::part(const Material& material, bool layered, bool water, bool wet) {
    std::vector<Define> defines = {{"PART", "1"}};
    unsigned key = 0;
    auto add = [&](bool wanted, unsigned bit, const char* name) {
        if (!wanted) return;
        key |= bit;
        defines.push_back({name, "1"});
    };
    add(material.skin != nullptr, 1, "SKIN");
    add(material.eye != nullptr && !material.skin, 2, "EYE");
    add(layered, 4, "LAYER");
    add(material.blended, 8, "BLENDED");
    add(water, 16, "WATER");
    add(glows(material), 32, "GLOW");
    add(wet, 64, "WET");
    if (const auto found = parts_.find(key); found != parts_.end()) return &found->second;
    Result<Program> made = Program::create(files_, {"shaders/material/mesh.vert", "shaders/material/part.frag"}, defines);
    if (!made) return made.error();
    return &parts_.emplace(key, std::move(*made)).first->second;
}

bool isPart(const Material& m) {
    return !m.clear && (m.skin || m.eye || m.blended || m.cutoff > 0 || !m.doubleSided || glows(m) || !imagesOf(m).empty());
}

bool canBeWet(const Material& m) { return !m.skin && !m.eye && !m.blended && !m.clear; }

TextureDesc shadowMapDesc(bool soft, bool quick) {
    const int size = kShadowSize / (soft ? 4 : 1) / (quick ? 2 : 1);
    return {.width = size, .height = size, .format = Format::rg32f};
}

void addShadow(FrameGraph& graph, RenderPrograms& programs, std::vector<DrawnMesh> meshes, const mat4& projection, TextureHandle sharp,
               TextureHandle soft, bool quick) {
    const TextureHandle depth = graph.texture("shadow depth", {.width = kShadowSize, .height = kShadowSize, .format = Format::depth32f});
    graph.pass("shadow", {}, {depth}, [=, &programs, drawn = std::move(meshes)](PassContext& c) {
        const gpu::Framebuffer& target = c.drawTo({}, depth);
        target.clearDepth();
        glEnable(GL_DEPTH_TEST);
        for (const DrawnMesh& m : drawn) {
            if (m.material.blended) continue;
            const bool holes = !isSolid(m.material);
            Program& program = holes ? programs.shadowHoles : programs.of(m).shadow;
            program.use();
            program.set("toClip", m.pose ? projection : projection * m.toWorld);
            if (m.pose) setTransform(program, m);
            if (holes) {
                program.texture("colourMap", 0, *m.textures.colour);
                program.set("opacity", m.material.opacity);
                program.set("cutoff", m.material.cutoff);
            }
            m.mesh->draw();
        }
    });
    auto blur = [&](Program& program, TextureHandle from, TextureHandle to, ivec2 axis, int reach) {
        graph.pass("shadow blur", {from}, {to}, [=, &program](PassContext& c) {
            c.drawTo({to});
            program.use();
            program.texture("source", 0, c.texture(from));
            program.set("axis", axis);
            program.set("reach", reach);
            program.set("scale", static_cast<float>(c.texture(from).width()) / static_cast<float>(c.texture(to).width()));
            c.drawFullscreen();
        });
    };
    const TextureDesc narrow = shadowMapDesc(false, quick);
    const TextureHandle across = graph.texture("shadow across", narrow), wide = graph.texture("shadow wide", shadowMapDesc(true, quick));
    const int softReach = quick ? (kShadowSoftReach + 1) / 2 : kShadowSoftReach;
    if (quick) {
        const TextureHandle halved = graph.texture("shadow halved", narrow);
        blur(programs.shadowHalve, depth, halved, {0, 0}, 0);
        blur(programs.shadowBlur, halved, across, {1, 0}, kShadowSharpReach);
    } else {
        blur(programs.shadowFirst, depth, across, {1, 0}, kShadowSharpReach);
    }
    blur(programs.shadowBlur, across, sharp, {0, 1}, kShadowSharpReach);
    blur(programs.shadowBlur, sharp, wide, {1, 0}, softReach);
    blur(programs.shadowBlur, wide, soft, {0, 1}, softReach);
}

TextureHandle addDepth(FrameGraph& graph, RenderPrograms& programs, BufferHandle frame, const FrameView& view,
                       std::vector<DrawnMesh> meshes) {
    const TextureHandle depth = graph.texture("scene depth", sized(view, Format::depth32f));
    graph.pass("depth", {{frame, Usage::uniform}}, {depth}, [=, &programs, drawn = std::move(meshes)](PassContext& c) {
        c.drawTo({}, depth);
        bindFrame(c, frame);
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_ALWAYS);  // the floor's depth, or 1, for every pixel: no clear needed
        programs.floorDepth.use();
        c.drawFullscreen();
        glDepthFunc(GL_LESS);
        for (const DrawnMesh& m : drawn) {
            if (!isSolid(m.material)) continue;
            Program& program = programs.of(m).depth;
            program.use();
            setTransform(program, m);
            cull(m);
            m.mesh->draw();
        }
        glDisable(GL_CULL_FACE);
    });
    return depth;
}

TextureHandle addOcclusion(FrameGraph& graph, RenderPrograms& programs, BufferHandle frame, const FrameView& view, TextureHandle depth,
                           float reach) {
    const TextureDesc half = sized(view, Format::rg16f, 2);
    TextureHandle open = graph.texture("occlusion", half);
    graph.pass("occlusion", {{frame, Usage::uniform}, depth}, {open}, [=, &programs](PassContext& c) {
        c.drawTo({open});
        bindFrame(c, frame);
        programs.occlusion.use();
        programs.occlusion.texture("sceneDepth", 0, c.texture(depth));
        programs.occlusion.set("reach", reach);
        c.drawFullscreen();
    });
    for (const ivec2 axis : {ivec2(1, 0), ivec2(0, 1)}) {
        const TextureHandle from = open, to = graph.texture("occlusion", half);
        graph.pass("occlusion blur", {from}, {to}, [=, &programs](PassContext& c) {
            c.drawTo({to});
            programs.occlusionBlur.use();
            programs.occlusionBlur.texture("source", 0, c.texture(from));
            programs.occlusionBlur.set("axis", axis);
            c.drawFullscreen();
        });
        open = to;
    }
    return open;
}

namespace {

void bindPlain(Program& p, const PassContext& c, TextureHandle occlusion, const LightMaps& light) {
    p.use();
    p.texture("occlusion", 0, c.texture(occlusion));
    bindLight(p, c, light, 1);
}

// Draws solid meshes, then cut-out ones, which write their own depth, then blended ones. A mesh with a layer is drawn dry, and again where
// it is wet: shading a liquid is much more expensive than the material below, and most of a skin is dry.
void drawParts(const PassContext& c, const std::vector<DrawnMesh>& drawn, const vec3& camera, TextureHandle occlusion,
               const LightMaps& light, TextureHandle colour, TextureHandle behind) {
    auto draw = [&](const DrawnMesh& m) {
        bindPlain(*m.part, c, occlusion, light);
        drawPart(m, *m.part, nullptr);
        if (m.wetPart == nullptr) return;
        bindPlain(*m.wetPart, c, occlusion, light);
        drawPart(m, *m.wetPart, m.layer);
    };
    std::vector<const DrawnMesh*> blended;
    for (const bool holes : {false, true}) {
        glDepthMask(holes ? GL_TRUE : GL_FALSE);
        for (const DrawnMesh& m : drawn)
            if (m.part != nullptr && !m.material.blended && isSolid(m.material) != holes) draw(m);
    }
    for (const DrawnMesh& m : drawn)
        if (m.part != nullptr && m.material.blended) blended.push_back(&m);
    auto away = [&](const DrawnMesh* m) { return glm::distance(vec3(m->toWorld * vec4(m->mesh->bounds().centre(), 1.0F)), camera); };
    std::stable_sort(blended.begin(), blended.end(), [&](const DrawnMesh* a, const DrawnMesh* b) { return away(a) > away(b); });
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    if (behind) {
        const gpu::Texture &from = c.texture(colour), &to = c.texture(behind);
        glCopyImageSubData(from.name(), GL_TEXTURE_2D, 0, 0, 0, 0, to.name(), GL_TEXTURE_2D, 0, 0, 0, 0, from.width(), from.height(), 1);
    }
    for (const DrawnMesh* m : blended) {
        Program& p = m->wetPart != nullptr ? *m->wetPart : *m->part;
        bindPlain(p, c, occlusion, light);
        if (m->wetPart != nullptr) p.texture("behindMap", 12, c.texture(behind));
        drawPart(*m, p, m->layer);
    }
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glFrontFace(GL_CCW);
}

}  // namespace

TextureHandle addOpaque(FrameGraph& graph, RenderPrograms& programs, BufferHandle frame, const FrameView& view,
                        std::vector<DrawnMesh> meshes, TextureHandle depth, TextureHandle occlusion, const LightMaps& light, bool floor,
                        const WetBuffers& wet) {
    const TextureHandle colour = graph.texture("scene colour", sized(view, Format::rgba16f));
    // A copy of the picture, which wet panes refract: a texture cannot be read while it is drawn into.
    const bool wetPanes = std::any_of(meshes.begin(), meshes.end(), [](const DrawnMesh& m) { return m.material.blended && m.wetPart; });
    const TextureHandle behind = wetPanes ? graph.texture("behind panes", sized(view, Format::rgba16f)) : TextureHandle{};
    std::vector<gpu::Write> targets = {colour};
    if (behind) targets.emplace_back(behind);
    std::vector<gpu::Read> reads = {{frame, Usage::uniform}, {depth, Usage::target}, occlusion, light.sharp, light.soft, light.water};
    for (const BufferHandle buffer : {wet.cells, wet.values})
        if (buffer) reads.emplace_back(buffer);
    graph.pass("opaque", reads, targets, [=, &programs, drawn = std::move(meshes)](PassContext& c) {
        c.drawTo({colour}, depth);
        bindFrame(c, frame);
        if (wet.values) {
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, c.buffer(wet.cells));
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, c.buffer(wet.values));
        }
        // The full-screen triangle is at the far plane: sky passes the depth test where nothing is nearer, the floor where
        // something is.
        glEnable(GL_DEPTH_TEST);
        glDepthMask(GL_FALSE);
        glDepthFunc(GL_EQUAL);
        programs.sky.use();
        c.drawFullscreen();
        glDepthFunc(GL_GREATER);
        if (floor) {  // optional, because it is shaded under meshes too, which hide it there
            programs.floor.use();
            programs.floor.texture("occlusion", 0, c.texture(occlusion));
            bindLight(programs.floor, c, light, 1);
            c.drawFullscreen();
        }
        glDepthFunc(GL_LEQUAL);
        for (const DrawnMesh& m : drawn) {
            if (m.part != nullptr || m.material.clear) continue;
            Program& p = m.wet ? programs.of(m).meshWet : programs.of(m).mesh;
            bindPlain(p, c, occlusion, light);
            setPlace(p, m);
            setWet(p, m);
            p.set("grain", vec2(m.material.grain, m.material.grainSize));
            m.mesh->draw();
        }
        drawParts(c, drawn, view.cameraPosWorld, occlusion, light, colour, behind);
    });
    return colour;
}

void addGlass(FrameGraph& graph, RenderPrograms& programs, BufferHandle frame, std::vector<DrawnMesh> meshes, TextureHandle colour,
              TextureHandle depth, const LightMaps& light, GlassSide side, TextureHandle fluidDepth) {
    std::erase_if(meshes, [](const DrawnMesh& m) { return !m.material.clear; });
    if (meshes.empty()) return;
    std::vector<gpu::Read> reads = {{frame, Usage::uniform}, {depth, Usage::target}, light.sharp, light.soft};
    if (side != GlassSide::all) reads.emplace_back(fluidDepth);
    graph.pass("glass", reads, {colour}, [=, &programs, drawn = std::move(meshes)](PassContext& c) {
        c.drawTo({colour}, depth);
        bindFrame(c, frame);
        Program& p = programs.glass;
        p.use();
        p.set("side", static_cast<int>(side));
        bindShadow(p, c, light, 1);
        if (side != GlassSide::all) p.texture("fluidDepth", 0, c.texture(fluidDepth));
        glEnable(GL_DEPTH_TEST);
        glDepthMask(GL_FALSE);
        glDepthFunc(GL_LEQUAL);
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_SRC1_COLOR);
        glEnable(GL_CULL_FACE);
        for (const DrawnMesh& m : drawn) {
            setPlace(p, m);
            p.set("opacity", m.material.opacity);
            glFrontFace(glm::determinant(mat3(m.toWorld)) < 0 ? GL_CW : GL_CCW);
            for (const GLenum hidden : {GL_FRONT, GL_BACK}) {  // back faces first
                glCullFace(hidden);
                m.mesh->draw();
            }
        }
        glCullFace(GL_BACK);
        glDisable(GL_CULL_FACE);
        glFrontFace(GL_CCW);
        glDisable(GL_BLEND);
    });
}

TextureHandle addGlassDepth(FrameGraph& graph, RenderPrograms& programs, BufferHandle frame, const FrameView& view,
                            std::vector<DrawnMesh> meshes) {
    std::erase_if(meshes, [](const DrawnMesh& m) { return !m.material.clear; });
    if (meshes.empty()) return {};
    const TextureHandle depth = graph.texture("glass depth", sized(view, Format::depth32f));
    graph.pass("glass depth", {{frame, Usage::uniform}}, {depth}, [=, &programs, drawn = std::move(meshes)](PassContext& c) {
        c.drawTo({}, depth).clearDepth();
        bindFrame(c, frame);
        glEnable(GL_DEPTH_TEST);
        programs.plain.depth.use();
        for (const DrawnMesh& m : drawn) {
            setTransform(programs.plain.depth, m);
            m.mesh->draw();
        }
    });
    return depth;
}

void addBox(FrameGraph& graph, RenderPrograms& programs, BufferHandle frame, const Bounds& box, TextureHandle colour, TextureHandle depth,
            TextureHandle fluidDepth) {
    std::vector<gpu::Read> reads = {{frame, Usage::uniform}, depth};
    if (fluidDepth) reads.emplace_back(fluidDepth);
    graph.pass("box", reads, {colour}, [=, &programs](PassContext& c) {
        c.drawTo({colour});
        bindFrame(c, frame);
        Program& p = fluidDepth ? programs.boxOverWater : programs.box;
        p.use();
        p.set("low", box.min);
        p.set("high", box.max);
        p.set("width", kBoxWidth);
        p.set("lineColour", kBoxColour);
        p.texture("sceneDepth", 0, c.texture(depth));
        if (fluidDepth) p.texture("fluidDepth", 1, c.texture(fluidDepth));
        glEnable(GL_BLEND);
        glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
        const gpu::VertexArray none = gpu::VertexArray::create();
        none.bind();
        glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, 12);
    });
}

void addTonemap(FrameGraph& graph, RenderPrograms& programs, BufferHandle frame, const FrameView& view, TextureHandle colour,
                TextureHandle picture, float exposure) {
    const TextureHandle mapped = graph.texture("tonemapped", sized(view, Format::rgba8));
    graph.pass("tonemap", {{frame, Usage::uniform}, colour}, {mapped}, [=, &programs](PassContext& c) {
        c.drawTo({mapped});
        bindFrame(c, frame);
        programs.tonemap.use();
        programs.tonemap.texture("sceneColour", 0, c.texture(colour));
        programs.tonemap.set("exposure", kExposure * std::exp2(exposure));
        c.drawFullscreen();
    });
    graph.pass("antialias", {{frame, Usage::uniform}, mapped}, {picture}, [=, &programs](PassContext& c) {
        c.drawTo({picture});
        bindFrame(c, frame);
        programs.antialias.use();
        programs.antialias.texture("picture", 0, c.texture(mapped));
        c.drawFullscreen();
    });
}

}  // namespace rivulet
