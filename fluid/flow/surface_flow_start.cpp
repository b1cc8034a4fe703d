#include "engine/core/assert.h"
#include "fluid/flow/surface_flow_impl.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "engine/core/param_check.h"
#include "fluid/flow/footprint.h"
#include "shaders/flow/cells.h"

namespace rivulet {

void SurfaceFlowParams::visit(ParamVisitor& v) {
    v.value({"surfaceTension", "N/m", "surface tension", 0.001, 1, kLog}, surfaceTension);
    v.value({"viscosity", "Pa s", "dynamic viscosity", 1.0e-5, 100, kLog}, viscosity);
    v.value({"density", "kg/m^3", "density", 1, 20000, kLog}, density);
    v.value({"advancing", "deg", "contact angle at a drop's front", 1, 175, kLinear, kFixed}, advancing);
    v.value({"receding", "deg", "contact angle at a drop's back; if it is larger than advancing, advancing is used for both", 1, 175,
             kLinear, kFixed},
            receding);
    v.value({"hold", "", "factor on the force that holds a drop; 1 = that of a disc with these angles", 0, 10}, hold);
    v.value({"unevenness", "",
             "how much that force varies over the skin, in spots of 3 and 9 mm: standard deviation over the mean; drops pause, and wander "
             "if they leave a trail",
             0, 0.5, kLinear, kFixed},
            unevenness);
    v.value({"drag", "", "force that slows a drop, over its width times viscosity times speed", 0, 10000}, drag);
    v.value({"wallFriction", "Pa s/m",
             "friction of the liquid on the skin; with it drag is ignored and follows from the contact angles; 0 = drag", 0, 1.0e9},
            wallFriction);
    v.value(
        {"adhesion", "",
         "factor on the largest volume that hangs under a skin; 1 = that of Young and Laplace's equation, whose shapes are drawn", 0, 10},
        adhesion);
    v.value({"airDrag", "", "drag coefficient of a drop in the wind", 0, 10}, airDrag);
    v.value({"largestDrop", "ul", "limit on the volume of a drop: drops that would exceed it do not merge, except where they hang", 0.01,
             100, kLog, kFixed},
            largestDrop);
    v.value({"touch", "", "distance at which two drops merge, over the sum of their radii", 0.1, 1, kLinear, kFixed}, touch);
    v.value({"footprint", "m", "width over which a drop's weight is spread", 0, 0.1, kLinear, kFixed}, footprint);
    v.value({"trail", "m", "thickness of the film that a drop leaves behind; 0 = none", 0, 1.0e-4}, trail);
    v.value({"trailWidth", "", "width of the trail, over the drop's", 0, 1}, trailWidth);
    v.value({"slip", "", "share of the force that holds a drop which a wet trail removes", 0, 1}, slip);
    v.value({"steer", "", "sideways pull of a trail next to a drop's path, over the force that holds the drop", 0, 2}, steer);
    v.value({"evaporation", "m/s", "evaporation rate of the film", 0, 1.0e-5}, evaporation);
    v.value({"filmCell", "m", "limit on the width of the film's cells", 1.0e-5, 0.1, kLog, kFixed}, filmCell);
    v.value({"filmReach", "m", "support radius of the sum that gives the film's height", 1.0e-4, 0.1, kLog, kFixed}, filmReach);
    v.value(
        {.name = "pearls", .doc = "whether a drop sheds small drops from its tail, at 1.49 times the speed at which a corner forms there"},
        pearls);
    v.value({.name = "contact", .doc = "whether drops pass to skin that faces them and that they touch: between lips, between lids"},
            contact);
    v.value({"brimHolds", "ul", "volume that an eyelid's brim holds before it overflows", 0.1, 100, kLog}, brimHolds);
    v.value({"brimStarts", "ul", "volume in an eyelid's brim at the start", 0.001, 100, kLog, kFixed}, brimStarts);
    v.value({"brimWidth", "m", "radius of the liquid in a brim", 1.0e-4, 0.01, kLog}, brimWidth);
    v.value({"tear", "ul", "volume of a drop that overflows a brim", 0.1, 30, kLog}, tear);
    v.value({"capacity", "", "limit on the number of drops", 1, 1 << 20, kLog, kFixed}, capacity);
}

// A factor of the holding force at each place: contact lines are pinned by spots of the surface (Joanny and de Gennes 1984). Two random
// fields, each a sum of plane waves, whose directions are spread evenly over the sphere.
static std::vector<float> unevenGrip(std::span<const vec3> rest, float deviation) {
    constexpr int kWaves = 12;
    constexpr float kLengths[] = {0.006F, 0.018F};  // m, of the waves: a spot is half as wide
    std::vector<float> grip(rest.size(), 1.0F);
    if (!(deviation > 0)) return grip;
    std::minstd_rand random(1);
    const auto uniform = [&] { return static_cast<float>(random()) / static_cast<float>(std::minstd_rand::max()); };
    for (const float length : kLengths)
        for (int k = 0; k < kWaves; ++k) {
            const float high = 1 - (2.0F * static_cast<float>(k) + 1) / float{kWaves}, flat = std::sqrt(1 - high * high);
            const float round = 2.3999632F * static_cast<float>(k), phase = 6.2831853F * uniform();  // the golden angle
            const vec3 wave = 6.2831853F / length * vec3(flat * std::cos(round), flat * std::sin(round), high);
            const float share = deviation / std::sqrt(float{kWaves});
            for (size_t p = 0; p < rest.size(); ++p) grip[p] += share * std::sin(glm::dot(wave, rest[p]) + phase);
        }
    for (float& g : grip) g = std::max(g, 0.1F);
    return grip;
}

Status SurfaceFlow::Impl::prepare(Device& on, std::span<const SkinBrim> along) {
    for (size_t k = 0; k < mesh.rest.size(); ++k)
        if (Status sound = checkPlace(mesh.given[k], mesh.rest[k]); !sound) return sound;
    device = &on;
    if (!thesis) pendant.emplace(double{params.advancing}, double{params.receding});
    brims = static_cast<uint32_t>(along.size());
    for (const SkinBrim& b : along) placesOf.push_back(static_cast<uint32_t>(b.places.size()));
    brimPlaces = std::accumulate(placesOf.begin(), placesOf.end(), 0U);
    const auto slots = static_cast<uint32_t>(params.capacity) + brimPlaces;
    Bounds around;
    for (const vec3& p : mesh.rest) around.add(p);
    // Cells as wide as the reach of two of the largest drops; wider on a large skin, which would have too many: they are counted in each
    // step, which on the cpu takes as long as all else for a few drops. They repeat in space, so that the skin may move anywhere; two sides
    // of it at rest are a cell apart.
    corners = around;
    const double reach =
        std::max(2 * double{params.touch} * contactRadius(meanAngle(params)) * std::cbrt(double{params.largestDrop} * kMicrolitre),
                 std::max(double{params.filmReach}, 2 * double{params.touch} * kFilmRadius * double{params.filmReach}));
    const double mostCells = on.backend() == Backend::cpu ? std::clamp(2.0 * slots, 2048.0, 8192.0) : 32768.0;
    const dvec3 size(around.size());
    double wide = reach;
    while ((size.x / wide + 2) * (size.y / wide + 2) * (size.z / wide + 2) > mostCells) wide *= 1.02;
    const float h = thesis ? thesis->cell() : static_cast<float>(wide);
    if (thesis)
        around = thesis->around();
    else
        around.add(around.max + h);
    PairTraits traits{.keeps = false};
    traits.repeats = !thesis;
    Result<NeighborGrid> made = NeighborGrid::create(on, around, h, slots, traits);
    if (!made) return made.error();
    grid = std::make_unique<NeighborGrid>(std::move(*made));
    if (!thesis) grid->setMargin(static_cast<float>(reach) / h);  // the cpu's lists hold the neighbours, however wide the cells
    Result<Particles> particles = Particles::create(on, slots);
    if (!particles) return particles.error();
    drops = std::move(*particles);

    struct Wanted {
        Kernel* kernel;
        const char* path;
    };
    for (const Wanted& w :
         {Wanted{&take, "flow/take"},      Wanted{&rest, "flow/rest"},   Wanted{&mark, "flow/mark"},   Wanted{&facing, "flow/facing"},
          Wanted{&goOver, "flow/go_over"}, Wanted{&basis, "flow/basis"}, Wanted{&stand, "flow/stand"}, Wanted{&drive, "flow/drive"},
          Wanted{&born, "flow/born"},      Wanted{&brim, "flow/brim"},   Wanted{&pearl, "flow/pearl"}, Wanted{&place, "flow/place"},
          Wanted{&name, "flow/name"},      Wanted{&merge, "flow/merge"}, Wanted{&law, "flow/law"},     Wanted{&steer, "flow/steer"},
          Wanted{&walk, "flow/walk"},      Wanted{&paint, "flow/paint"}, Wanted{&dry, "flow/dry"},     Wanted{&leave, "flow/leave"}}) {
        Result<Kernel> found = on.kernel(w.path);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    for (auto [kernel, path] : {std::pair(&meet, "flow/meet"), std::pair(&gather, "flow/gather"), std::pair(&spread, "flow/spread"),
                                std::pair(&press, "flow/press")}) {
        Result<PairKernel> found = PairKernel::find(on, path, on.backend() == Backend::cpu ? PairTraits() : traits);
        if (!found) return found.error();
        *kernel = *found;
    }
    if (Status fits = layLattice(); !fits) return fits;
    const Footprint under = footprintOf(mesh, thesis ? 0.0F : params.footprint);  // the thesis uses the model's normals
    const size_t triangles = mesh.triangleCount(), places = mesh.rest.size(), n = slots;
    const size_t positions = size_t{*std::max_element(mesh.given.begin(), mesh.given.end())} + 1;
    for (auto [buffer, bytes] : {std::pair(&skin, SKIN_UINTS * triangles * sizeof(uint32_t)),
                                 std::pair(&film, firstCell.back() * sizeof(uint32_t)),
                                 std::pair(&point, places * sizeof(vec4)),
                                 std::pair(&frames, 5 * triangles * sizeof(vec4)),
                                 std::pair(&given, places * sizeof(uint32_t)),
                                 std::pair(&hostMoved, positions * sizeof(vec4)),
                                 std::pair(&driven, 2 * places * sizeof(vec4)),
                                 std::pair(&wanted, places * sizeof(uint32_t)),
                                 std::pair(&painted, triangles * sizeof(uint32_t)),
                                 std::pair(&begin, under.begin.size() * sizeof(uint32_t)),
                                 std::pair(&footprint, under.triangle.size() * sizeof(uint32_t)),
                                 std::pair(&weight, under.weight.size() * sizeof(float)),
                                 std::pair(&drop, n * DROP_UINTS * sizeof(uint32_t)),
                                 std::pair(&motion, MOTION_VECS * n * sizeof(vec4)),
                                 std::pair(&side, n * sizeof(vec4)),
                                 std::pair(&chain, 2 * size_t{brims} * sizeof(uint32_t)),
                                 std::pair(&spill, size_t{brimPlaces} * sizeof(FlowBirth)),
                                 std::pair(&names, n * sizeof(float)),
                                 std::pair(&sortedOf, n * sizeof(uint32_t)),
                                 std::pair(&faces, n * sizeof(uint32_t)),
                                 std::pair(&reached, (REACHED_WORDS + 1) * sizeof(uint32_t)),
                                 std::pair(&into, n * sizeof(float)),
                                 std::pair(&merged, 2 * n * sizeof(vec4)),
                                 std::pair(&shift, n * sizeof(vec4)),
                                 std::pair(&birth, n * sizeof(FlowBirth)),
                                 std::pair(&counter, FLOW_COUNTERS * sizeof(uint32_t)),
                                 std::pair(&left, MOST_LEFT * sizeof(FlowLeft)),
                                 std::pair(&hangs, MOST_HANGING * sizeof(FlowHanging))}) {
        Result<Buffer> room = on.allocate(bytes);
        if (!room) return room.error();
        *buffer = std::move(*room);
    }
    std::vector<uint32_t> table;
    table.reserve(SKIN_UINTS * triangles);
    for (size_t t = 0; t < triangles; ++t) {
        table.insert(table.end(), {mesh.corner[3 * t], mesh.corner[3 * t + 1], mesh.corner[3 * t + 2]});
        table.insert(table.end(), {mesh.across[3 * t], mesh.across[3 * t + 1], mesh.across[3 * t + 2]});
        const uint32_t cells = firstCell[t + 1] - firstCell[t];
        table.insert(table.end(), {firstCell[t], static_cast<uint32_t>(std::lround(std::sqrt(static_cast<double>(cells))))});
    }
    on.writeAll<uint32_t>(skin, table);
    std::vector<vec4> at;
    at.reserve(places);
    for (size_t p = 0; p < places; ++p) at.emplace_back(mesh.rest[p], static_cast<float>(under.triangle[under.begin[p]]));
    on.writeAll<vec4>(point, at);
    on.writeAll<uint32_t>(given, mesh.given);
    uneven = unevenGrip(mesh.rest, params.unevenness);
    std::vector<vec4> usual(2 * places, vec4(0.0F));
    for (size_t p = 0; p < places; ++p) {
        usual[2 * p].w = uneven[p];
        usual[2 * p + 1].w = DRIVE_STALE;
    }
    on.writeAll<vec4>(driven, usual);
    on.writeAll<uint32_t>(begin, under.begin);
    on.writeAll<uint32_t>(footprint, under.triangle);
    on.writeAll<float>(weight, under.weight);
    std::vector<uint32_t> ids(n);
    for (uint32_t k = 0; k < slots; ++k) ids[k] = k;
    on.writeAll<uint32_t>(drops.id, ids);
    std::vector<vec4> free(n, vec4(0.0F, 0.0F, 0.0F, -1.0F));
    for (size_t k = 0, id = size_t(params.capacity); k < along.size(); ++k)
        for (const SkinPoint& p : along[k].places) free[id++] = vec4(positionOf(mesh, p), 0.0F);
    on.writeAll<vec4>(drops.positionNext, free);
    if (Status filled = fillBrims(along); !filled) return filled;
    // Drops spawned in the first step use the free slots of the last sort.
    StepParams s{};
    s.h = h;
    s.invH = 1 / h;
    s.count = s.firstSample = slots;
    grid->fill(s);
    // Drawing before the first step shows the skin at rest.
    FlowStep f{};
    f.triangles = static_cast<uint32_t>(triangles);
    on.run(basis, f, {&skin, &point, &frames}, f.triangles);
    reports->inUse = brimPlaces;
    return grid->build(s, drops);
}

Status SurfaceFlow::Impl::fillBrims(std::span<const SkinBrim> along) {
    std::vector<uint32_t> chains, state(size_t{count()} * DROP_UINTS, 0);
    std::vector<FlowBirth> spills;
    for (const SkinBrim& b : along) {
        if (b.places.empty() || b.spills.size() != b.places.size())
            return badInput(
                fmt::format("a brim has {} places and {} to spill at: give as many, and at least one", b.places.size(), b.spills.size()));
        chains.insert(chains.end(), {static_cast<uint32_t>(spills.size()), static_cast<uint32_t>(b.places.size())});
        for (size_t k = 0; k < b.places.size(); ++k) {
            const SkinPoint &p = b.places[k], &s = b.spills[k];
            ASSERT(p.triangle < mesh.triangleCount() && s.triangle < mesh.triangleCount(), "a brim's triangles are the mesh's");
            uint32_t* d = &state[(static_cast<size_t>(params.capacity) + spills.size()) * DROP_UINTS];
            const uint32_t volume = std::max(b.picolitres / static_cast<uint32_t>(b.places.size()), 1U);
            d[DROP_TRIANGLE] = DROP_BRIM | p.triangle;
            d[DROP_B1] = std::bit_cast<uint32_t>(p.b1);
            d[DROP_B2] = std::bit_cast<uint32_t>(p.b2);
            d[DROP_VOLUME] = volume;
            added += volume;
            spills.push_back({vec4(0.0F), s.triangle, s.b1, s.b2, 0});
        }
    }
    device->writeAll<uint32_t>(drop, state);
    device->writeAll<uint32_t>(chain, chains);
    device->writeAll<FlowBirth>(spill, spills);
    return ok();
}

// Enough rows that no cell's side is longer than filmCell.
Status SurfaceFlow::Impl::layLattice() {
    constexpr uint64_t kMostCells = uint64_t{1} << 28U;
    firstCell.assign(1, 0);
    uint64_t cells = 0;
    for (size_t t = 0; t < mesh.triangleCount(); ++t) {
        float longest = 0;
        for (size_t k = 0; k < 3; ++k)
            longest = std::max(longest, glm::distance(mesh.rest[mesh.corner[3 * t + k]], mesh.rest[mesh.corner[3 * t + (k + 1) % 3]]));
        const double rows = std::max(std::ceil(double{longest} / double{params.filmCell}), 1.0);
        cells += static_cast<uint64_t>(std::min(rows * rows, 2.0 * kMostCells));
        if (cells > kMostCells)
            return badInput(fmt::format("the skin is so large that its film would have more than {} cells of {} m: make filmCell larger",
                                        kMostCells, params.filmCell));
        firstCell.push_back(static_cast<uint32_t>(cells));
    }
    return ok();
}

SurfaceFlow::SurfaceFlow(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SurfaceFlow::SurfaceFlow(SurfaceFlow&&) noexcept = default;
SurfaceFlow& SurfaceFlow::operator=(SurfaceFlow&&) noexcept = default;
SurfaceFlow::~SurfaceFlow() = default;

const FlowMesh& SurfaceFlow::mesh() const { return impl_->mesh; }
const SurfaceFlowParams& SurfaceFlow::params() const { return impl_->params; }

Result<SurfaceFlow> SurfaceFlow::create(Device& device, FlowMesh mesh, const SurfaceFlowParams& params, std::span<const SkinBrim> brims) {
    if (Status s = checkParams("liquid", params); !s) return s.error();
    auto impl = std::make_unique<Impl>();
    impl->mesh = std::move(mesh);
    impl->params = params;
    if (Status ready = impl->prepare(device, brims); !ready) return ready.error();
    return SurfaceFlow(std::move(impl));
}

Result<SurfaceFlow> SurfaceFlow::createThesis(Device& device, FlowMesh mesh, std::span<const vec2> uvs, const SurfaceFlowParams& params,
                                              const ThesisParams& thesis) {
    if (Status s = checkParams("liquid", params); !s) return s.error();
    if (Status s = checkParams("thesis", thesis); !s) return s.error();
    Result<ThesisTables> tables = ThesisTables::create(device, mesh, uvs, thesis);
    if (!tables) return tables.error();
    auto impl = std::make_unique<Impl>();
    impl->mesh = std::move(mesh);
    impl->params = params;
    impl->params.filmCell = 1.0e6F;  // m: no film
    impl->thesis.emplace(std::move(*tables));
    if (Status ready = impl->prepare(device, {}); !ready) return ready.error();
    return SurfaceFlow(std::move(impl));
}

}  // namespace rivulet
