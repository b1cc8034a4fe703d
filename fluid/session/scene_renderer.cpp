#include "fluid/session/scene_renderer.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "engine/render/made_sky.h"
#include "engine/scene/light.h"
#include "engine/scene/load_image.h"
#include "engine/scene/transform.h"
#include "shaders/fluid/solids/body_state.h"

namespace rivulet {
namespace {

constexpr float kOcclusionReach = 0.16F;  // of the shown scene's radius
constexpr auto kPoseTexels = static_cast<int>(sizeof(DeviceBody) / sizeof(vec4));

void copyTexels(const gpu::Texture& from, const gpu::Texture& to, int left) {
    glCopyImageSubData(from.name(), GL_TEXTURE_2D, 0, left, 0, 0, to.name(), GL_TEXTURE_2D, 0, left, 0, 0, from.width() - left,
                       from.height(), 1);
}

gpu::TextureHandle addCopy(gpu::FrameGraph& graph, gpu::TextureHandle of) {
    const gpu::TextureHandle copy = graph.texture("copy for the split", graph.desc(of));
    graph.pass("split copy", {{of, gpu::Usage::copy}}, {{copy, gpu::Usage::copy}},
               [=](gpu::PassContext& c) { copyTexels(c.texture(of), c.texture(copy), 0); });
    return copy;
}

// The right half of a picture into another, and a line where they meet.
void addRightHalf(gpu::FrameGraph& graph, gpu::TextureHandle from, gpu::TextureHandle into) {
    graph.pass("split", {{from, gpu::Usage::copy}}, {into}, [=](gpu::PassContext& c) {
        const gpu::Texture& to = c.texture(into);
        const int middle = to.width() / 2;
        copyTexels(c.texture(from), to, middle);
        const gpu::Framebuffer& target = c.drawTo({into});
        glEnable(GL_SCISSOR_TEST);
        glScissor(middle, 0, 1, to.height());
        target.clearColour(vec4(1.0F));
        glDisable(GL_SCISSOR_TEST);
    });
}

}  // namespace

Camera cameraOf(const CameraParams& params, const Bounds& bounds) {
    Camera camera;
    camera.position = params.position;
    camera.target = params.target;
    camera.fieldOfView = params.fieldOfView;
    camera.setPlanes(bounds);
    return camera;
}

Result<std::optional<HdrImage>> surroundingsOf(const SceneFile& scene) {
    const BackgroundParams& background = scene.background;
    if (background.surroundings.empty() && background.sky == "studio") return std::optional<HdrImage>();
    if (background.surroundings.empty())
        return std::optional(makeSky({.sun = glm::normalize(scene.light.direction),
                                      .sunlight = scene.light.colour * scene.light.intensity,
                                      .horizon = background.horizon,
                                      .zenith = background.zenith,
                                      .ground = background.floor,
                                      .clouds = background.clouds}));
    Result<std::string> path = findAsset(scene.background.surroundings, scene.folder);
    if (!path) return path.error();
    Result<HdrImage> image = loadHdr(*path);
    if (!image) return image.error();
    for (vec3& texel : image->texels) texel *= scene.background.surroundingsLevel;
    return std::optional<HdrImage>(std::move(*image));
}

FrameView frameViewOf(const Camera& camera, const LightParams& light, int width, int height, double time) {
    FrameView view;
    view.width = std::max(width, 1);
    view.height = std::max(height, 1);
    view.view = camera.view();
    view.projection = camera.projection(static_cast<float>(view.width) / static_cast<float>(view.height));
    view.cameraPosWorld = camera.position;
    view.nearPlane = camera.nearPlane;
    view.farPlane = camera.farPlane;
    view.lightDirWorld = glm::normalize(light.direction);
    view.lightColour = light.colour * light.intensity;
    view.time = time;
    return view;
}

Result<std::unique_ptr<SceneRenderer>> SceneRenderer::create(const ShaderFiles& from, const HdrImage* surroundings, const Log& log) {
    std::unique_ptr<SceneRenderer> r(new SceneRenderer());
    ShaderFiles files = from;
    if (surroundings != nullptr) {
        const Environment made = cachedEnvironment(*surroundings, DiskCache(cacheFolder("surroundings"), log));
        Result<gpu::Texture> map = makeEnvironmentMap(made);
        if (!map) return map.error();
        r->surroundings_ = std::move(*map);
        r->matteLight_ = made.matte;
        files.define({"ENVIRONMENT_MAP", "1"});
    }
    Result<RenderPrograms> render = RenderPrograms::create(files);
    if (!render) return render.error();
    Result<LensPrograms> lens = LensPrograms::create(files);
    if (!lens) return lens.error();
    Result<FluidPrograms> fluid = FluidPrograms::create(files);
    if (!fluid) return fluid.error();
    Result<gpu::Buffer> frame = gpu::Buffer::create(sizeof(FrameParams));
    if (!frame) return frame.error();
    Result<gpu::Texture> nothing = gpu::Texture::create({.width = 1, .height = 1, .format = gpu::Format::rgba8});
    if (!nothing) return nothing.error();
    nothing->clear(vec4(0.0F));
    for (const bool quick : {false, true}) {
        for (const auto& [into, soft] : {std::pair(&r->shadowSharp_, false), std::pair(&r->shadowSoft_, true)}) {
            Result<gpu::Texture> map = gpu::Texture::create(shadowMapDesc(soft, quick));
            if (!map) return map.error();
            (*into)[quick ? 1 : 0] = std::move(*map);
        }
    }
    r->render_ = std::move(*render);
    r->lens_ = std::move(*lens);
    r->fluid_ = std::move(*fluid);
    r->frame_ = std::move(*frame);
    Result<gpu::Buffer> coarse = gpu::Buffer::create(sizeof(FrameParams));
    if (!coarse) return coarse.error();
    r->coarse_ = std::move(*coarse);
    r->nothing_ = std::move(*nothing);
    return r;
}

Result<size_t> SceneRenderer::reload() {
    std::vector<gpu::Program*> programs = render_.all();
    for (gpu::Program* program : lens_.all()) programs.push_back(program);
    for (gpu::Program* program : fluid_.all()) programs.push_back(program);
    Result<size_t> others = gpu::Program::reload(programs);
    if (others && *others > 0) {
        shadowOf_.clear();
        fluid_.kept.clear();
    }
    return others;
}

// Meshes that are new go to the GPU, those that are gone leave it, and the picture takes the view's size.
Status SceneRenderer::prepare(const FrameView& view, const Scene& scene) {
    std::set<MeshKey> used;
    std::set<const Image*> seen;
    for (const Node& node : scene.nodes()) {
        if (!node.mesh) continue;
        const MeshKey key = keyOf(node);
        used.insert(key);
        seen.merge(imagesOf(node.material));
        if (!meshes_.contains(key)) {
            Result<GpuMesh> mesh = GpuMesh::create(*node.mesh);
            if (!mesh) return mesh.error();
            meshes_.emplace(key, std::move(*mesh));
        }
        GpuMesh& mesh = meshes_.at(key);
        if (node.deformed)
            if (Status followed = mesh.follow(*node.deformed); !followed) return followed;
        if (node.deformer)
            if (Status followed = mesh.follow(*node.deformer); !followed) return followed;
    }
    std::erase_if(meshes_, [&](const auto& item) { return !used.contains(item.first); });
    images_.keepOnly(seen);
    if (!picture_ || width() != view.width || height() != view.height) {
        Result<gpu::Texture> picture = gpu::Texture::create({.width = view.width, .height = view.height, .format = gpu::Format::rgba8});
        if (!picture) return picture.error();
        picture_ = std::move(*picture);
    }
    return ok();
}

// Meshes of bodies on the device are drawn where it has them. Their programs are made before it moves a body for the first time.
Status SceneRenderer::readPoses(const FluidView& fluid, const Scene& scene) {
    const auto isBody = [](const Node& node) { return node.body >= 0; };
    if (fluid.bodyCount == 0 || std::ranges::none_of(scene.nodes(), isBody)) return ok();
    if (Status made = render_.preparePosed(); !made || !fluid.hasNewPoses()) return made;
    if (!poseRows_) {
        GLuint name = 0;
        glCreateTextures(GL_TEXTURE_BUFFER, 1, &name);
        poseRows_ = gpu::TextureName(name);
    }
    glTextureBuffer(poseRows_.name(), GL_RGBA32F, fluid.bodies);
    return ok();
}

Result<DrawnMesh> SceneRenderer::drawnOf(const Scene& scene, size_t at, const mat4& toWorld, const FluidView& fluid) {
    const Node& node = scene.nodes()[at];
    DrawnMesh drawn;
    drawn.mesh = &meshes_.at(keyOf(node));
    drawn.toWorld = toWorld;
    drawn.material = node.material;
    if (node.layer && node.layer->texels != nullptr && *node.layer->texels) drawn.layer = node.layer.get();
    if (fluid.wetness != 0 && canBeWet(node.material)) drawn.wet = node.wet;
    if (!isPart(node.material) && drawn.layer == nullptr) {
        const std::optional<size_t> body = fluid.hasNewPoses() && !node.material.clear ? scene.bodyOf(at) : std::nullopt;
        if (!body) return drawn;
        const Node& moved = scene.nodes()[*body];
        drawn.pose = DevicePose{poseRows_.name(), moved.body * kPoseTexels, scene.toBody(at)};
        if (drawn.wet) drawn.wet->fromWorld *= moved.local;
        return drawn;
    }
    for (const bool wet : {false, true}) {
        if (wet && drawn.layer == nullptr) continue;
        Result<gpu::Program*> part = render_.part(node.material, wet, fluid.count > 0 && !fluid.bounds.empty(), !wet && drawn.wet);
        if (!part) return part.error();
        (wet ? drawn.wetPart : drawn.part) = *part;
    }
    Result<MaterialTextures> textures = images_.texturesOf(node.material);
    if (!textures) return textures.error();
    drawn.textures = *textures;
    return drawn;
}

// The maps are drawn again only after the light or a mesh has moved.
void SceneRenderer::addShadows(gpu::FrameGraph& graph, const std::vector<DrawnMesh>& meshes, const mat4& projection, const Scene& scene,
                               const FluidView& fluid, LightMaps& light) {
    std::vector<uint64_t> versions;
    bool deforms = false;
    for (const Node& node : scene.nodes()) {
        versions.push_back(node.deformed ? node.deformed->version : node.deformer ? node.deformer->version() : 0);
        deforms = deforms || node.deformer || node.deformed;
    }
    light.sharp = graph.importTexture("shadow, sharp", shadowSharp_[deforms ? 1 : 0]);
    light.soft = graph.importTexture("shadow, soft", shadowSoft_[deforms ? 1 : 0]);
    std::vector<mat4> places = {projection};
    std::vector<const GpuMesh*> drawn;
    for (const DrawnMesh& m : meshes) {
        places.push_back(m.toWorld);
        drawn.push_back(m.mesh);
    }
    std::shared_ptr<const void> poses;
    if (std::ranges::any_of(meshes, [](const DrawnMesh& m) { return m.pose.has_value(); })) poses = fluid.bodiesMoved;
    if (places == shadowOf_ && drawn == shadowMeshes_ && versions == shadowVersions_ && poses == shadowPoses_) return;
    addShadow(graph, render_, meshes, projection, light.sharp, light.soft, deforms);
    shadowVersion_ = (shadowVersion_ + 1) % 16777216;  // a float can hold it
    graph.output(light.sharp);
    graph.output(light.soft);
    shadowOf_ = std::move(places);
    shadowMeshes_ = std::move(drawn);
    shadowVersions_ = std::move(versions);
    shadowPoses_ = std::move(poses);
}

Status SceneRenderer::draw(const FrameView& view, const FluidView& fluid, const Scene& scene, const SceneFile& settings) {
    const RendererRow* row = renderers().find(settings.look.renderer);
    if (row == nullptr) return badInput(fmt::format("look.renderer '{}' is unknown", settings.look.renderer));
    const RendererRow* other = settings.look.split.empty() ? nullptr : renderers().find(settings.look.split);
    if (other == nullptr && !settings.look.split.empty()) return badInput(fmt::format("look.split '{}' is unknown", settings.look.split));
    Result<FluidLook> look = fluidLookOf(settings.look, settings.fluid.liquid);
    if (!look) return look.error();
    if (settings.look.quality == "auto") look->fast = hurries_;
    if (Status s = fluid_.fits(fluid); !s) return s;
    if (Status s = prepare(view, scene); !s) return s;
    if (Status s = readPoses(fluid, scene); !s) return s;

    std::vector<DrawnMesh> meshes;
    const std::vector<mat4> world = scene.worldMatrices();
    const std::vector<bool> visible = scene.visible();
    const Bounds water = fluid.count > 0 ? fluid.bounds : Bounds{};
    Bounds solid;
    for (size_t i = 0; i < scene.nodes().size(); ++i) {
        const Node& node = scene.nodes()[i];
        if (!visible[i] || !node.mesh) continue;
        Result<DrawnMesh> drawn = drawnOf(scene, i, world[i], fluid);
        if (!drawn) return drawn.error();
        const Bounds b = transformBounds(world[i], drawn->mesh->bounds());
        meshes.push_back(std::move(*drawn));
        solid.add(b.min);
        solid.add(b.max);
    }
    const BackgroundParams& background = settings.background;
    Studio studio{background.horizon,     background.zenith,  background.floor,
                  background.floorHeight, background.tiles,   background.showFloor,
                  settings.light.fill,    settings.light.rim, solid};
    const Bounds box{settings.fluid.box.min, settings.fluid.box.max};
    studio.shown.add(box.min);
    studio.shown.add(box.max);
    FrameParams params = packFrame(view, studio, solid, water);
    std::copy(matteLight_.begin(), matteLight_.end(), params.matteLight);
    const bool caustics = look->caustics && !row->opaque && !water.empty();
    if (caustics) params.shadow.y = 2.0F;
    frame_.write(std::as_bytes(std::span(&params, 1)));
    if (look->fast) {
        const FrameParams half = packFrame(view.half(), studio, solid, water);
        coarse_.write(std::as_bytes(std::span(&half, 1)));
    }
    if (surroundings_) surroundings_.bind(16);  // beyond those that the graph empties before each pass

    gpu::FrameGraph graph(pool_);
    const gpu::BufferHandle frame = graph.importBuffer("frame", frame_.name(), frame_.bytes());
    const gpu::TextureHandle nothing = graph.importTexture("nothing", nothing_);
    LightMaps light{nothing, nothing, nothing, look->absorption + look->scattering};
    if (!meshes.empty()) addShadows(graph, meshes, params.shadowProjection, scene, fluid, light);
    FluidDraw draw;
    draw.view = view;
    draw.fluid = fluid;
    draw.look = *look;
    draw.fluid.exposure *= settings.timeScale;
    if (look->fast) draw.fluid.ellipsoids = {};
    draw.frame = frame;
    if (look->fast) draw.coarse = graph.importBuffer("coarse frame", coarse_.name(), coarse_.bytes());
    draw.progress = progress_;
    if (fluid.count > 0) {
        draw.position = graph.importBuffer("positions", fluid.position, size_t{fluid.count} * sizeof(vec4));
        draw.velocity = graph.importBuffer("velocities", fluid.velocity, size_t{fluid.count} * sizeof(vec4));
        draw.id = graph.importBuffer("ids", fluid.id, size_t{fluid.count} * sizeof(uint32_t));
        if (fluid.absorption != 0)
            draw.absorption = graph.importBuffer("absorptions", fluid.absorption, size_t{fluid.count} * sizeof(vec4));
    }
    if (fluid.count > 0 && draw.fluid.ellipsoids[0] != 0)
        for (const unsigned name : draw.fluid.ellipsoids)
            draw.ellipsoids.push_back(graph.importBuffer("ellipsoids", name, size_t{fluid.count} * sizeof(vec4)));
    draw.shadowSharp = light.sharp;
    draw.shadowSoft = light.soft;
    draw.shadowVersion = shadowVersion_;
    draw.receivers = {params.shadow.x, params.floorFade.w, params.floorColour.w};
    draw.look.caustics = caustics;  // the map of the water has another layout for them
    if (!water.empty()) light.water = addWaterLight(graph, fluid_, draw, params.waterProjection);
    if (caustics) light.water = draw.caustics = addCaustics(graph, fluid_, draw, light.water, params.waterProjection);
    if (row->opaque) light.absorption = vec3(60.0F);  // spheres of paint let no light through

    draw.depth = addDepth(graph, render_, frame, view, meshes);
    const float radius = 0.5F * glm::length(studio.shown.size());
    const gpu::TextureHandle occlusion = addOcclusion(graph, render_, frame, view, draw.depth, kOcclusionReach * radius);
    WetBuffers wet;
    if (fluid.wetness != 0)
        wet = {graph.importBuffer("wet cells", fluid.wetCells, fluid.wetCellBytes),
               graph.importBuffer("wetness", fluid.wetness, fluid.wetnessBytes)};
    draw.colour = addOpaque(graph, render_, frame, view, meshes, draw.depth, occlusion, light, studio.showFloor, wet);
    if (fluid.foamCount > 0) draw.glassDepth = addGlassDepth(graph, render_, frame, view, meshes);

    if (background.showBox && !row->opaque) addBox(graph, render_, frame, box, draw.colour, draw.depth);
    const auto glass = [&](gpu::TextureHandle colour, gpu::TextureHandle depth, gpu::TextureHandle fluidDepth, GlassSide side) {
        addGlass(graph, render_, frame, meshes, colour, depth, light, fluidDepth ? side : GlassSide::all, fluidDepth);
    };
    FluidDraw second = draw;
    if (other != nullptr) {
        second.colour = addCopy(graph, draw.colour);
        second.depth = addCopy(graph, draw.depth);
    }
    // What shows how the surface is made is of the surface alone.
    const bool whole = look->view == WaterView::water;
    for (FluidDraw* d : {&draw, &second})
        d->behind = [&, d = *d](gpu::TextureHandle colour, gpu::TextureHandle fluidDepth) {
            if (whole && d.glassDepth) addFoam(graph, fluid_, d, {colour, fluidDepth}, FoamSide::glazed);
            glass(colour, d.depth, fluidDepth, GlassSide::behind);
        };
    gpu::TextureHandle seen = draw.depth;  // with drops
    const auto addRest = [&](const FluidDraw& d, const FluidLayers& of) {
        if (!whole) return;
        addFoam(graph, fluid_, d, of, of.fluidDepth && d.glassDepth ? FoamSide::rest : FoamSide::all);
        const gpu::TextureHandle with = addDrops(graph, fluid_, d, of);
        if (&d == &draw) seen = with;
        glass(of.colour, d.depth, of.fluidDepth, GlassSide::before);
    };
    FluidLayers layers = row->add(graph, fluid_, draw);
    addRest(draw, layers);
    if (other != nullptr) {
        const FluidLayers right = other->add(graph, fluid_, second);
        addRest(second, right);
        addRightHalf(graph, right.colour, layers.colour);
    }
    if (background.showBox && (row->opaque || layers.fluidDepth))
        addBox(graph, render_, frame, box, layers.colour, draw.depth, layers.fluidDepth);

    const CameraParams& camera = settings.camera;
    const float atTarget = std::max(-(view.view * vec4(camera.target, 1.0F)).z, view.nearPlane);
    const Lens lens{.exposure = camera.exposure,
                    .bloom = camera.bloom,
                    .aperture = camera.aperture,
                    .focus = camera.focus > 0 ? camera.focus : atTarget,
                    .automatic = camera.focus <= 0};
    layers.colour = addDepthOfField(graph, lens_, frame, view, lens, layers.colour, seen, layers.fluidDepth);
    layers.colour = addBloom(graph, lens_, lens, layers.colour);
    const gpu::TextureHandle picture = graph.importTexture("picture", picture_);
    addTonemap(graph, render_, frame, view, layers.colour, picture, lens.exposure);
    graph.output(picture);
    description_.reset();
    if (Status drawn = graph.execute(); !drawn) return drawn;
    if (describes_) description_ = graph.describe();
    return ok();
}

void SceneRenderer::present(GLuint framebuffer, int width, int height) const {
    if (picture_) gpu::Framebuffer(picture_, nullptr).blitTo(framebuffer, width, height);
}

void SceneRenderer::finish() {
    glFinish();
    pool_.collect();
}

std::vector<uint8_t> SceneRenderer::pixels() const {
    if (!picture_) return {};
    const size_t row = static_cast<size_t>(width()) * 4, rows = static_cast<size_t>(height());
    std::vector<uint8_t> bottomUp(row * rows), topDown(row * rows);
    picture_.read(std::as_writable_bytes(std::span(bottomUp)));
    for (size_t y = 0; y < rows; ++y)
        std::copy_n(bottomUp.begin() + static_cast<std::ptrdiff_t>(y * row), row,
                    topDown.begin() + static_cast<std::ptrdiff_t>((rows - 1 - y) * row));
    return topDown;
}

}  // namespace rivulet
