#include "fluid/render/water_renderer.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>

#include "engine/core/readable_bytes.h"
#include "engine/gpu/host_state.h"
#include "engine/gpu/load.h"
#include "engine/render/environment_map.h"
#include "engine/render/frame_params.h"
#include "fluid/render/host_picture.h"
#include "fluid/render/host_surroundings.h"
#include "fluid/render/look_params.h"
#include "fluid/render/pack_lighting.h"
#include "fluid/render/renderers.h"

namespace rivulet {

struct WaterRenderer::Impl {
    FluidPrograms fluid;
    HostPicture picture;
    gpu::TransientPool pool;
    gpu::Buffer frame, coarse;
    gpu::Texture nothing, surroundings;
    gpu::Sampler plainSampler;
    std::array<vec4, 9> matte{};
    std::optional<SurroundingsMap> hosts;  // instead of `surroundings` and `matte`
    size_t most = SIZE_MAX;                // bytes of pictures

    size_t ownBytes() const { return surroundings.desc().bytes() + nothing.desc().bytes() + (hosts ? hosts->bytes() : 0); }
    Status create(const WaterRendererOptions& options);
    Status setSurroundings(const HostSurroundings& from);
    Status draw(const FluidView& fluidView, const FluidLook& look, const RendererRow& row, const FrameView& host,
                const HostLighting& lighting);
};

namespace {

constexpr unsigned kSurroundingsUnit = 16, kShadowUnit = 17;  // beyond those that the graph empties before each pass

ShaderFiles shaderFiles() {
    ShaderFiles files = ShaderFiles::developer();
    files.define({"ENVIRONMENT_MAP", "1"});
    files.define({"HOST_LIGHT", "1"});
    return files;
}

}  // namespace

Status WaterRenderer::Impl::create(const WaterRendererOptions& options) {
    const ShaderFiles files = shaderFiles();
    const DiskCache cache(cacheFolder("surroundings"), options.log);
    const Environment filtered =
        options.surroundings != nullptr ? cachedEnvironment(*options.surroundings, cache) : cachedEnvironment(options.sky, cache);
    Result<gpu::Texture> map = makeEnvironmentMap(filtered);
    if (!map) return map.error();
    surroundings = std::move(*map);
    matte = filtered.matte;
    plainSampler = gpu::Sampler({.min = gpu::Filter::nearest, .mag = gpu::Filter::nearest}, false);
    Result<FluidPrograms> programs = FluidPrograms::create(files);
    if (!programs) return programs.error();
    fluid = std::move(*programs);
    Result<HostPicture> host = HostPicture::create(files);
    if (!host) return host.error();
    picture = std::move(*host);
    for (gpu::Buffer* buffer : {&frame, &coarse}) {
        Result<gpu::Buffer> block = gpu::Buffer::create(sizeof(FrameParams));
        if (!block) return block.error();
        *buffer = std::move(*block);
    }
    Result<gpu::Texture> texel = gpu::Texture::create({.width = 1, .height = 1, .format = gpu::Format::rgba8});
    if (!texel) return texel.error();
    nothing = std::move(*texel);
    nothing.clear(vec4(0.0F));
    most = options.memoryLimit;
    if (const size_t taken = ownBytes(); taken > most)
        return failed(
            fmt::format("surroundings need {}, and {} are allowed for pictures; allow more", readableBytes(taken), readableBytes(most)));
    return ok();
}

Status WaterRenderer::Impl::setSurroundings(const HostSurroundings& from) {
    const size_t left = most - std::min(most, ownBytes());
    if (hosts) return hosts->take(from, left);
    Result<SurroundingsMap> made = SurroundingsMap::create(shaderFiles());
    if (!made) return made.error();
    if (Status taken = made->take(from, left); !taken) return taken;
    hosts = std::move(*made);
    return ok();
}

Status WaterRenderer::Impl::draw(const FluidView& fluidView, const FluidLook& look, const RendererRow& row, const FrameView& host,
                                 const HostLighting& lighting) {
    const FrameView& view = picture.view();
    fluid.kept.limit(most - std::min(most, ownBytes() + picture.bytes() + pool.bytes()));
    Studio studio;
    studio.showFloor = false;
    const Bounds water = fluidView.count > 0 ? fluidView.bounds : Bounds();
    const auto packed = [&](const FrameView& of) {
        FrameParams params = packFrame(of, studio, {}, water);
        std::copy(matte.begin(), matte.end(), params.matteLight);
        packLighting(lighting, host, params);
        return params;
    };
    const FrameParams params = packed(view);
    frame.write(std::as_bytes(std::span(&params, 1)));
    if (look.fast) {
        const FrameParams half = packed(view.half());
        coarse.write(std::as_bytes(std::span(&half, 1)));
    }
    if (hosts)
        for (const gpu::Buffer* block : {&frame, &coarse})
            glCopyNamedBufferSubData(hosts->matte().name(), block->name(), 0, offsetof(FrameParams, matteLight),
                                     static_cast<GLsizeiptr>(hosts->matte().bytes()));
    (hosts ? hosts->map() : surroundings).bind(kSurroundingsUnit);

    gpu::FrameGraph graph(pool);
    const gpu::TextureHandle none = graph.importTexture("nothing", nothing);
    FluidDraw d;
    d.view = view;
    d.fluid = fluidView;
    d.look = look;
    d.user = row.user;
    if (look.fast) d.fluid.ellipsoids = {};
    d.frame = graph.importBuffer("frame", frame.name(), frame.bytes());
    if (look.fast) d.coarse = graph.importBuffer("coarse frame", coarse.name(), coarse.bytes());
    const auto rows = [&](const char* name, unsigned buffer, size_t bytes) {
        return graph.importBuffer(name, buffer, fluidView.count * bytes);
    };
    if (fluidView.count > 0) {
        d.position = rows("positions", fluidView.position, sizeof(vec4));
        d.velocity = rows("velocities", fluidView.velocity, sizeof(vec4));
        d.id = rows("ids", fluidView.id, sizeof(uint32_t));
        if (fluidView.absorption != 0) d.absorption = rows("absorptions", fluidView.absorption, sizeof(vec4));
        if (d.fluid.ellipsoids[0] != 0)
            for (const unsigned name : d.fluid.ellipsoids) d.ellipsoids.push_back(rows("ellipsoids", name, sizeof(vec4)));
    }
    d.colour = graph.importTexture("scene", picture.colour());
    d.depth = graph.importTexture("scene depth", picture.depth());
    d.shadowSharp = d.shadowSoft = none;
    if (row.opaque) {  // it draws into the picture itself, and the host's is needed to tell where
        const gpu::TextureHandle own = graph.texture("picture", picture.colour().desc());
        copyTexels(graph, "copy scene", d.colour, own);
        d.colour = own;
    }
    const FluidLayers layers = row.add(graph, fluid, d);
    if (look.view == WaterView::water) {
        addFoam(graph, fluid, d, layers, FoamSide::all);
        addDrops(graph, fluid, d, layers);
    }
    graph.output(layers.colour);
    if (layers.fluidDepth) graph.output(layers.fluidDepth);
    pool.limit(most - std::min(most, ownBytes() + picture.bytes() + fluid.kept.bytes()));
    if (Status ran = graph.execute(); !ran) return ran;
    picture.give(graph.result(layers.colour), layers.fluidDepth ? &graph.result(layers.fluidDepth) : nullptr);
    return ok();
}

namespace {

bool isEmpty(const FluidView& fluid) { return fluid.count == 0 && fluid.foamCount == 0 && fluid.dropCount == 0 && fluid.pendantCount == 0; }
// Whether it is a row of the table, whose passes change only what HostState::rivulets saves.
bool isOurs(const RendererRow* row) { return row == nullptr || renderers().find(row->name) == row; }

}  // namespace

WaterRenderer::WaterRenderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

WaterRenderer::~WaterRenderer() = default;

Result<std::unique_ptr<WaterRenderer>> WaterRenderer::create(const WaterRendererOptions& options) {
    if (!gpu::loaded())
        return badInput("OpenGL's functions are not loaded: call rivulet::gpu::load with what finds them, glfwGetProcAddress say, first");
    const gpu::HostState keep;
    auto impl = std::make_unique<Impl>();
    if (Status made = impl->create(options); !made) return made.error();
    return std::unique_ptr<WaterRenderer>(new WaterRenderer(std::move(impl)));
}

Status WaterRenderer::draw(const FrameView& view, const FluidView& fluid, const FluidLook& look, const HostTarget& target,
                           const RendererRow* row, const HostLighting& lighting) {
    if (isEmpty(fluid)) return ok();
    const gpu::HostState scope(isOurs(row) ? gpu::HostState::rivulets : gpu::HostState::everything);
    return draw(scope, view, fluid, look, target, row, lighting);
}

Status WaterRenderer::draw(const gpu::HostState& scope, const FrameView& view, const FluidView& fluid, const FluidLook& look,
                           const HostTarget& target, const RendererRow* row, const HostLighting& lighting) {
    if (Status fits = impl_->fluid.fits(fluid); !fits) return fits;
    if (isEmpty(fluid)) return ok();
    if (Status can = HostPicture::nothingUnderWay(); !can) return can;
    if (Status can = usable(lighting); !can) return can;
    impl_->picture.limit(impl_->most - impl_->ownBytes());
    if (Status taken = impl_->picture.take(target, scope.depth(), view); !taken) return taken;
    const RendererRow& by = row != nullptr ? *row : *renderers().find(FluidLookParams().renderer);
    std::optional<gpu::BoundUnit> unit;
    if (lighting.shadow.texture != 0) {
        unit.emplace(kShadowUnit, GL_TEXTURE_2D);
        glBindTextureUnit(kShadowUnit, lighting.shadow.texture);
        impl_->plainSampler.bind(kShadowUnit);  // which compares nothing
    }
    Status drawn = impl_->draw(fluid, look, by, view, lighting);
    if (!drawn && impl_->fluid.kept.bytes() > 0) {  // what is kept only saves time: it gives way to the pictures of this frame
        impl_->fluid.kept.clear();
        drawn = impl_->draw(fluid, look, by, view, lighting);
    }
    return drawn;
}

Status WaterRenderer::setSurroundings(const HostSurroundings& surroundings) {
    const gpu::HostState scope;
    return setSurroundings(scope, surroundings);
}

Status WaterRenderer::setSurroundings(const gpu::HostState&, const HostSurroundings& surroundings) {
    return impl_->setSurroundings(surroundings);
}

const std::vector<PassTime>& WaterRenderer::times() const { return impl_->pool.times(); }

size_t WaterRenderer::bytes() const { return impl_->pool.bytes() + impl_->picture.bytes() + impl_->fluid.kept.bytes() + impl_->ownBytes(); }

}  // namespace rivulet
