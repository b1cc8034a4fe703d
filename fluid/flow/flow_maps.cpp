#include "fluid/flow/flow_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/core/assert.h"
#include "fluid/flow/map_texels.h"
#include "fluid/flow/skin_folds.h"
#include "fluid/flow/surface_flow_impl.h"
#include "shaders/flow/cells.h"
#include "shaders/flow/map_step.h"

namespace rivulet {

struct FlowMaps::Impl {
    Device* device = nullptr;
    int size = 0, mips = 0;
    Kernel caps, thick, bounds, touch, around, rows, mip;
    Buffer tile, texel, pinBegin, pin, chart, cover;  // made once
    Buffer box, cap, film, near, stamp, map, reached;
    uint32_t tiles = 0, pieces = 0;
    bool hangsApart = false;
    bool whole = false;  // tiles are drawn by one thread each, with mips 2 and 3
    uint32_t drawn = 0;
    uint64_t moved = 0;    // FlowView::moved when the boxes were made
    uint32_t stepped = 0;  // FlowView::steps when it was last drawn

    Status prepare(const FlowView& flow, const SurfaceFlowParams& params, MapTexels& made);
    size_t before(int level) const {
        size_t texels = 0;
        for (int k = 0; k < level; ++k) texels += static_cast<size_t>(size >> k) * static_cast<size_t>(size >> k);
        return texels;
    }
    int coverLevel() const { return whole ? std::min(3, mips - 1) : 1; }  // the first level whose cover is used
    FlowMapStep stepOf(const FlowView& flow, const SurfaceFlowParams& params) const;
};

Status FlowMaps::Impl::prepare(const FlowView& flow, const SurfaceFlowParams& params, MapTexels& made) {
    device = flow.device;
    size = made.size;
    mips = std::bit_width(static_cast<uint32_t>(size));
    tiles = static_cast<uint32_t>(made.tiles());
    pieces = static_cast<uint32_t>(made.pieces());
    struct Wanted {
        Kernel* kernel;
        const char* path;
    };
    for (const Wanted& w : {Wanted{&caps, "flow/map_caps"}, Wanted{&thick, "flow/map_thick"}, Wanted{&bounds, "flow/map_bounds"},
                            Wanted{&touch, "flow/map_touch"}, Wanted{&around, "flow/map_taps"}, Wanted{&mip, "flow/map_mips"}}) {
        Result<Kernel> found = device->kernel(w.path);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    whole = device->backend() == Backend::cpu;
    Result<Kernel> drawing = device->kernel(whole ? "flow/map_tiles" : "flow/map_quads");
    if (!drawing) return drawing.error();
    rows = *drawing;
    Buffer shown, taps;
    const size_t above = before(mips) - before(3), all = before(mips);
    const std::span<const float> asked = std::span(made.cover).subspan(before(coverLevel()) - before(1));
    for (auto [buffer, bytes] :
         {std::pair(&tile, made.tile.size() * sizeof(uint32_t)), std::pair(&shown, made.texel.size() * sizeof(uint32_t)),
          std::pair(&taps, 3 * made.texel.size() * sizeof(uint32_t)), std::pair(&pinBegin, made.pinBegin.size() * sizeof(uint32_t)),
          std::pair(&pin, made.pin.size() * sizeof(uint32_t)), std::pair(&chart, made.chart.size() * sizeof(vec4)),
          std::pair(&cover, asked.size_bytes()), std::pair(&box, 2 * made.pieces() * sizeof(vec4)),
          std::pair(&cap, CAP_VECS * size_t{flow.slots} * sizeof(vec4)),
          // The last block of cells may end behind the last triangle's.
          std::pair(&film, flow.film->bytes() / 2 + (made.chart.size() + 4) * sizeof(uint32_t)),
          std::pair(&near, ((NEAR_UINTS + 1) * made.tiles() + 1) * sizeof(uint32_t)), std::pair(&stamp, above * sizeof(uint32_t)),
          std::pair(&reached, (REACHED_WORDS + 1) * sizeof(uint32_t)), std::pair(&map, 2 * all * sizeof(uint32_t))}) {
        Result<Buffer> room = device->allocate(bytes);
        if (!room) return room.error();
        *buffer = std::move(*room);
    }
    device->writeAll<uint32_t>(pinBegin, made.pinBegin);
    device->writeAll<uint32_t>(pin, made.pin);
    device->writeAll<vec4>(chart, made.chart);
    device->writeAll<float>(cover, asked);
    // The film's cells about each texel, from the skin as it is now.
    device->writeAll<uint32_t>(tile, made.tile);
    device->writeAll<uint32_t>(shown, made.texel);
    const FlowMapStep s = stepOf(flow, params);
    device->run(around, s, {&tile, &chart, flow.skin, flow.basis, &shown, &taps}, tiles * TILE_TEXELS);
    const std::vector<uint32_t> packed = packTexels(made, device->readAll<uint32_t>(taps, 3 * made.texel.size()));
    Result<Buffer> room = device->allocate(packed.size() * sizeof(uint32_t));
    if (!room) return room.error();
    texel = std::move(*room);
    device->writeAll<uint32_t>(texel, packed);
    device->writeAll<uint32_t>(tile, made.tile);
    return ok();
}

FlowMapStep FlowMaps::Impl::stepOf(const FlowView& flow, const SurfaceFlowParams& params) const {
    const StepParams& grid = flow.grid;
    FlowMapStep s{};
    s.gridOrigin = grid.gridOrigin;
    s.gridScale = grid.gridScale;
    s.cellsX = grid.cellsX;
    s.cellsY = grid.cellsY;
    s.cellsZ = grid.cellsZ;
    s.finer = grid.cellCount / static_cast<uint32_t>(grid.cellsX * grid.cellsY * grid.cellsZ);
    s.insideAt = grid.cellCount;
    s.slots = flow.slots;
    s.triangles = static_cast<uint32_t>(flow.basis->bytes() / (5 * sizeof(vec4)));
    s.tiles = tiles;
    s.pieces = pieces;
    s.size = static_cast<uint32_t>(size);
    s.draw = drawn;
    s.since = stepped;
    s.moved = flow.moved != moved ? 1 : 0;
    s.reach = flow.largestRadius;
    s.inverseReach = 1 / s.reach;
    s.coverFrom = static_cast<uint32_t>(before(coverLevel()));
    s.trail = std::max(params.trail, 1.0e-6F);
    s.tap = 0.6F * params.filmCell;
    s.contactRadius = static_cast<float>(contactRadius(meanAngle(params)));
    s.hangsApart = hangsApart ? 1.0F : 0.0F;
    s.receding = glm::radians(std::max(std::min(params.receding, params.advancing), 10.0F));
    s.advancing = std::max(glm::radians(params.advancing), s.receding);
    s.inverseCorner = static_cast<float>(1 / cornerSpeed(params));
    return s;
}

std::vector<vec2> cornerUvs(const FlowMesh& mesh, const MeshView& from) {
    std::vector<vec2> uvs;
    if (from.uvs.size() != from.positions.size()) return uvs;
    uvs.reserve(mesh.corner.size());
    for (size_t k = 0; k < mesh.corner.size(); ++k) {
        const uint32_t* given = &from.indices[3 * size_t{mesh.source[k / 3]}];
        const uint32_t* same = std::find_if(given, given + 3, [&](uint32_t i) { return from.positions[i] == mesh.rest[mesh.corner[k]]; });
        ASSERT(same != given + 3, "hand the mesh that the flow mesh was made of");
        uvs.push_back(from.uvs[*same]);
    }
    return uvs;
}

FlowMaps::FlowMaps(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FlowMaps::FlowMaps(FlowMaps&&) noexcept = default;
FlowMaps& FlowMaps::operator=(FlowMaps&&) noexcept = default;
FlowMaps::~FlowMaps() = default;

Result<FlowMaps> FlowMaps::create(const SurfaceFlow& flow, std::span<const vec2> uvs, int size) {
    if (size < kLeastSize || size > kMostSize || !std::has_single_bit(static_cast<uint32_t>(size)))
        return badInput(
            fmt::format("a flow's maps cannot have {0} x {0} texels: give a power of two from {1} to {2}", size, kLeastSize, kMostSize));
    const FlowMesh& mesh = flow.mesh();
    if (uvs.size() != mesh.corner.size())
        return badInput(fmt::format("a flow's maps have {} UVs for {} corners: give one for each corner of each triangle", uvs.size(),
                                    mesh.corner.size()));
    const FlowView view = flow.view();
    if (view.onLayout) return badInput("a flow in thesis mode has no maps: draw it by thesisPicture()");
    MapTexels made = layTexels(mesh, uvs, skinFolds(mesh, view.largestRadius), size);
    if (made.tiles() == 0) return badInput("no triangle of the skin has an area in UV: give it UVs, or unwrap it");
    auto impl = std::make_unique<Impl>();
    if (Status ready = impl->prepare(view, flow.params(), made); !ready) return ready.error();
    return FlowMaps(std::move(impl));
}

void FlowMaps::leaveOutHanging(bool leaveOut) { impl_->hangsApart = leaveOut; }

void FlowMaps::draw(const SurfaceFlow& flow) {
    Impl& w = *impl_;
    const FlowView v = flow.view();
    ASSERT(v.device == w.device, "draw the flow that the maps were made for");
    if (v.moved == 0) return;
    ++w.drawn;
    FlowMapStep s = w.stepOf(v, flow.params());
    Device& d = *w.device;
    if (s.moved > 0) d.run(w.bounds, s, {&w.pinBegin, &w.pin, v.point, &w.chart, v.basis, &w.box}, w.pieces);
    w.moved = v.moved;
    w.stepped = v.steps;
    d.fill(w.reached, 0);
    d.run(w.caps, s, {v.cellStart, v.position, v.velocity, v.id, &w.cap, &w.reached, &w.near, v.motion}, s.slots);
    d.run(w.thick, s, {v.skin, v.basis, v.film, v.painted, &w.film}, s.triangles);
    d.run(w.touch, s, {&w.tile, &w.box, v.cellStart, &w.cap, &w.near, &w.stamp, &w.reached}, w.tiles);
    d.run(w.rows, s, {&w.texel, &w.chart, v.skin, v.basis, &w.cap, &w.film, &w.near, &w.map}, w.whole ? w.tiles : 16 * w.tiles);
    for (int level = 2; level < w.mips; ++level) {
        if (level == 3 || (level == 2 && w.whole)) continue;  // 3 is made with 2
        const uint32_t edge = s.size >> static_cast<uint32_t>(level);
        s.level = static_cast<uint32_t>(level);
        s.levelTexels = edge * edge;
        s.levelAt = static_cast<uint32_t>(w.before(level));
        s.aboveAt = static_cast<uint32_t>(w.before(level - 1));
        if (level > 3) {
            s.stampAt = s.levelAt - static_cast<uint32_t>(w.before(3));
            s.stampAbove = s.aboveAt - static_cast<uint32_t>(w.before(3));
        }
        d.run(w.mip, s, {&w.cover, &w.stamp, &w.map, &w.near}, level == 2 ? w.tiles : edge * edge);
    }
}

Device& FlowMaps::device() const { return *impl_->device; }
int FlowMaps::size() const { return impl_->size; }
int FlowMaps::mips() const { return impl_->mips; }
const Buffer& FlowMaps::texels() const { return impl_->map; }
size_t FlowMaps::texelsBefore(int mip) const { return impl_->before(mip); }
const Buffer& FlowMaps::stamps() const { return impl_->stamp; }
uint32_t FlowMaps::draws() const { return impl_->drawn; }
size_t FlowMaps::tiles() const { return impl_->tiles; }

}  // namespace rivulet
