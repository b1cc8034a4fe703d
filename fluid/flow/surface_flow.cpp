#include "fluid/flow/surface_flow.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "fluid/flow/footprint.h"
#include "fluid/sim/neighbor_grid.h"
#include "fluid/sim/step_context.h"
#include "shaders/flow/flow_step.h"

namespace rivulet {

namespace {

constexpr double kRadian = 3.14159265358979323846 / 180;
constexpr double kMicrolitre = 1.0e-9;  // m^3

// Radius of the foot of a cap over the cube root of its volume.
double contactRadius(double degrees) {
    const double c = std::cos(degrees * kRadian), s = std::sin(degrees * kRadian);
    return std::cbrt(3 * s * s * s / (3.14159265358979323846 * (2 - 3 * c + c * c * c)));
}

double meanAngle(const SurfaceFlowParams& p) { return 0.5 * double{p.advancing + p.receding}; }

}  // namespace

void SurfaceFlowParams::visit(ParamVisitor& v) {
    constexpr bool kLog = true, kLinear = false, kFixed = true;
    v.value({"surfaceTension", "N/m", "", 0.001, 1, kLog}, surfaceTension);
    v.value({"viscosity", "Pa s", "dynamic", 1.0e-5, 100, kLog}, viscosity);
    v.value({"density", "kg/m^3", "", 1, 20000, kLog}, density);
    v.value({"advancing", "deg", "contact angle at a drop's front", 1, 175}, advancing);
    v.value({"receding", "deg", "contact angle at its back; where it is the larger one, the front's holds for both", 1, 175}, receding);
    v.value({"hold", "", "of the force that holds a drop, over that of a disc with these angles", 0, 10}, hold);
    v.value({"drag", "", "of the force that slows it, over its width times viscosity times speed", 0, 10000}, drag);
    v.value({"adhesion", "", "of the force that keeps a drop on a skin it hangs from", 0, 10}, adhesion);
    v.value({"airDrag", "", "drag coefficient of a drop in the wind", 0, 10}, airDrag);
    v.value({"largestDrop", "ul", "what would be more together stays several drops", 0.01, 1000, kLog, kFixed}, largestDrop);
    v.value({"touch", "", "of the sum of their radii: drops as near are one", 0.1, 1}, touch);
    v.value({"footprint", "m", "over which a drop's weight is spread", 0, 0.1, kLinear, kFixed}, footprint);
    v.value({"trail", "m", "thickness of the film that a drop leaves behind; 0 = none", 0, 1.0e-4}, trail);
    v.value({"trailWidth", "", "of the trail, over the drop's", 0, 1}, trailWidth);
    v.value({"slip", "", "share of what holds a drop that a wet way takes", 0, 1}, slip);
    v.value({"steer", "", "how strongly a trail beside its way pulls a drop in, of what holds it", 0, 2}, steer);
    v.value({"evaporation", "m/s", "of the film", 0, 1.0e-5}, evaporation);
    v.value({"filmCell", "m", "the film's cells are no wider", 1.0e-5, 0.1, kLog, kFixed}, filmCell);
    v.value({"capacity", "", "drops at most", 1, 1 << 20, kLog, kFixed}, capacity);
}

struct SurfaceFlow::Impl {
    Device* device = nullptr;
    FlowMesh mesh;
    SurfaceFlowParams params;
    std::unique_ptr<NeighborGrid> grid;
    Particles drops;  // as the grid sorts them: position.w radius, velocity.w volume
    Kernel basis, drive, born, place, name, merge, law, walk, paint, dry, leave;
    PairKernel meet, gather;
    Buffer skin, point, frames, driven, begin, footprint, weight;  // of the mesh
    Buffer drop, motion;                                           // by id
    Buffer names, sortedOf, into, merged, shift;                   // sorted
    Buffer film;                                                   // picolitres, of each cell
    Buffer birth, counter, left;
    std::vector<uint32_t> firstCell;   // of each triangle's lattice, and the end
    uint32_t phase = 0;                // whose turn it is to dry
    double sinceTurn[DRY_EVERY] = {};  // s
    std::vector<FlowBirth> births;
    uint64_t added = 0;  // picolitres
    // What the device tells: shared with reads that are still on their way.
    struct Told {
        uint64_t refused = 0, left = 0, evaporated = 0;  // picolitres
        uint64_t merges = 0;
        uint32_t leaving = 0;  // in the step that is being told
        std::vector<LeftDrop> gone;
    };
    std::shared_ptr<Told> told = std::make_shared<Told>();
    bool moved = true;  // the basis is to be made anew

    uint32_t count() const { return drops.count; }
    Status prepare(Device& on);
    Status layLattice();
    Status checkPositions(std::span<const vec3> positions) const;
    FlowStep stepOf(const SurfaceFlowInputs& inputs, const StepParams& s, double seconds) const;
    void takeCounters();
};

Status SurfaceFlow::Impl::prepare(Device& on) {
    device = &on;
    const auto slots = static_cast<uint32_t>(params.capacity);
    Bounds around;
    for (const vec3& p : mesh.rest) around.add(p);
    const vec3 size = around.size();
    const float longest = std::max({size.x, size.y, size.z});
    // A skin may move within a margin. Cells as wide as two of the largest drops reach; wider on a large skin, whose cells would be too
    // many: they are counted anew each step.
    const float margin = 0.25F * longest;
    around.add(around.min - margin);
    around.add(around.max + margin);
    const double reach = 2 * double{params.touch} * contactRadius(meanAngle(params)) * std::cbrt(double{params.largestDrop} * kMicrolitre);
    constexpr double kCells = 1 << 17;
    const dvec3 all(around.size());
    const float h = static_cast<float>(std::max(reach, std::cbrt(all.x * all.y * all.z / kCells)));
    Result<NeighborGrid> made = NeighborGrid::create(on, around, h, slots);
    if (!made) return made.error();
    grid = std::make_unique<NeighborGrid>(std::move(*made));
    Result<Particles> particles = Particles::create(on, slots);
    if (!particles) return particles.error();
    drops = std::move(*particles);

    struct Wanted {
        Kernel* kernel;
        const char* path;
    };
    for (const Wanted& w :
         {Wanted{&basis, "flow/basis"}, Wanted{&drive, "flow/drive"}, Wanted{&born, "flow/born"}, Wanted{&place, "flow/place"},
          Wanted{&name, "flow/name"}, Wanted{&merge, "flow/merge"}, Wanted{&walk, "flow/walk"}, Wanted{&leave, "flow/leave"},
          Wanted{&law, "flow/law"}, Wanted{&paint, "flow/paint"}, Wanted{&dry, "flow/dry"}}) {
        Result<Kernel> found = on.kernel(w.path);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    for (auto [kernel, path] : {std::pair(&meet, "flow/meet"), std::pair(&gather, "flow/gather")}) {
        Result<PairKernel> found = PairKernel::find(on, path, {});
        if (!found) return found.error();
        *kernel = *found;
    }
    if (Status fits = layLattice(); !fits) return fits;
    const Footprint under = footprintOf(mesh, params.footprint);
    const size_t triangles = mesh.triangleCount(), places = mesh.rest.size(), n = slots;
    for (auto [buffer, bytes] :
         {std::pair(&skin, SKIN_UINTS * triangles * sizeof(uint32_t)), std::pair(&film, firstCell.back() * sizeof(uint32_t)),
          std::pair(&point, places * sizeof(vec4)), std::pair(&frames, 5 * triangles * sizeof(vec4)),
          std::pair(&driven, places * sizeof(vec4)), std::pair(&begin, under.begin.size() * sizeof(uint32_t)),
          std::pair(&footprint, under.triangle.size() * sizeof(uint32_t)), std::pair(&weight, under.weight.size() * sizeof(float)),
          std::pair(&drop, n * DROP_UINTS * sizeof(uint32_t)), std::pair(&motion, n * sizeof(vec4)), std::pair(&names, n * sizeof(float)),
          std::pair(&sortedOf, n * sizeof(uint32_t)), std::pair(&into, n * sizeof(float)), std::pair(&merged, n * sizeof(vec4)),
          std::pair(&shift, n * sizeof(vec4)), std::pair(&birth, n * sizeof(FlowBirth)),
          std::pair(&counter, FLOW_COUNTERS * sizeof(uint32_t)), std::pair(&left, MOST_LEFT * sizeof(FlowLeft))}) {
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
    for (const vec3& p : mesh.rest) at.emplace_back(p, 0.0F);
    on.writeAll<vec4>(point, at);
    on.writeAll<uint32_t>(begin, under.begin);
    on.writeAll<uint32_t>(footprint, under.triangle);
    on.writeAll<float>(weight, under.weight);
    std::vector<uint32_t> ids(n);
    for (uint32_t k = 0; k < slots; ++k) ids[k] = k;
    on.writeAll<uint32_t>(drops.id, ids);
    const std::vector<vec4> free(n, vec4(0.0F, 0.0F, 0.0F, -1.0F));
    on.writeAll<vec4>(drops.positionNext, free);
    // The first step's births look where the last sort put free slots.
    StepParams s{};
    s.h = h;
    s.invH = 1 / h;
    s.count = s.firstSample = slots;
    grid->fill(s);
    return grid->build(s, drops);
}

// Rows so many that no cell's side is longer than asked.
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

Status SurfaceFlow::Impl::checkPositions(std::span<const vec3> positions) const {
    if (positions.empty()) return ok();
    for (const uint32_t k : mesh.given) {
        if (k >= positions.size())
            return badInput(fmt::format("a skin was given {} positions, too few: its triangles use number {}", positions.size(), k));
        if (!isFinite(positions[k])) return badInput(fmt::format("position {} of a skin is not a finite number", k));
    }
    return ok();
}

FlowStep SurfaceFlow::Impl::stepOf(const SurfaceFlowInputs& inputs, const StepParams& s, double seconds) const {
    constexpr double kAirDensity = 1.2;  // kg/m^3
    const SurfaceFlowParams& p = params;
    const double advancing = double{p.advancing} * kRadian, receding = double{std::min(p.receding, p.advancing)} * kRadian;
    FlowStep f{};
    f.pull = vec4(inputs.pull, 0.0F);
    f.wind = vec4(inputs.wind, 0.0F);
    f.count = count();
    f.triangles = static_cast<uint32_t>(mesh.triangleCount());
    f.places = static_cast<uint32_t>(mesh.rest.size());
    f.births = static_cast<uint32_t>(births.size());
    f.insideAt = s.cellCount;
    f.freeAt = s.totalCells + 2;
    f.dt = static_cast<float>(seconds);
    f.density = p.density;
    f.contactRadius = static_cast<float>(contactRadius(meanAngle(p)));
    f.hold = static_cast<float>(double{p.hold * p.surfaceTension} * (std::cos(receding) - std::cos(advancing)));
    f.drag = p.drag * p.viscosity;
    f.adhesion = static_cast<float>(double{p.adhesion * p.surfaceTension} * 3.14159265358979323846 * std::sin(advancing));
    f.airDrag = static_cast<float>(0.5 * kAirDensity * double{p.airDrag} * 0.4);  // a cap's height is about 0.4 of its width
    f.trail = p.trail;
    f.trailWidth = p.trailWidth;
    f.slip = p.slip;
    f.steer = p.steer;
    f.cell = p.filmCell;
    return f;
}

SurfaceFlow::SurfaceFlow(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SurfaceFlow::SurfaceFlow(SurfaceFlow&&) noexcept = default;
SurfaceFlow& SurfaceFlow::operator=(SurfaceFlow&&) noexcept = default;
SurfaceFlow::~SurfaceFlow() = default;

const FlowMesh& SurfaceFlow::mesh() const { return impl_->mesh; }
const SurfaceFlowParams& SurfaceFlow::params() const { return impl_->params; }

Result<SurfaceFlow> SurfaceFlow::create(Device& device, FlowMesh mesh, const SurfaceFlowParams& params) {
    auto impl = std::make_unique<Impl>();
    impl->mesh = std::move(mesh);
    impl->params = params;
    if (Status ready = impl->prepare(device); !ready) return ready.error();
    return SurfaceFlow(std::move(impl));
}

void SurfaceFlow::setParams(const SurfaceFlowParams& params) {
    SurfaceFlowParams p = params;
    p.capacity = impl_->params.capacity;
    p.footprint = impl_->params.footprint;
    p.largestDrop = impl_->params.largestDrop;
    impl_->params = p;
}

void SurfaceFlow::add(const SkinPoint& at, uint32_t picolitres, const vec3& velocity) {
    ASSERT(at.triangle < impl_->mesh.triangleCount(), "a drop's triangle is one of mesh()'s");
    if (picolitres == 0) return;
    impl_->added += picolitres;
    if (impl_->births.size() >= impl_->count()) {
        impl_->told->refused += picolitres;
        return;
    }
    impl_->births.push_back({vec4(velocity, 0.0F), at.triangle, at.b1, at.b2, picolitres});
}

// On a GPU both come some frames later, one after the other.
void SurfaceFlow::Impl::takeCounters() {
    device->readLater(counter, counter.bytes(), [to = std::weak_ptr(told)](std::span<const std::byte> bytes) {
        const std::shared_ptr<Told> t = to.lock();
        if (!t) return;  // the flow is no more
        const auto* c = reinterpret_cast<const uint32_t*>(bytes.data());
        t->refused += c[0];
        t->merges += c[1];
        t->leaving = std::min(c[2], MOST_LEFT);
        t->left += c[3];
        t->evaporated += c[4];
    });
    device->readLater(left, left.bytes(), [to = std::weak_ptr(told)](std::span<const std::byte> bytes) {
        const std::shared_ptr<Told> t = to.lock();
        if (!t) return;
        const auto* first = reinterpret_cast<const FlowLeft*>(bytes.data());
        std::vector<FlowLeft> some(first, first + t->leaving);
        std::sort(some.begin(), some.end(), [](const FlowLeft& a, const FlowLeft& b) { return a.position.w < b.position.w; });
        for (const FlowLeft& l : some) t->gone.push_back({vec3(l.position), vec3(l.velocity), l.volume, l.triangle});
    });
}

Status SurfaceFlow::step(const SurfaceFlowInputs& inputs, double seconds) {
    Impl& w = *impl_;
    w.device->poll();
    if (!(seconds > 0)) return ok();
    if (Status places = w.checkPositions(inputs.positions); !places) return places;
    StepParams s{};
    s.count = s.firstSample = w.count();
    w.grid->fill(s);
    s.h = 1 / s.gridScale.x;
    s.invH = s.gridScale.x;
    s.dt = static_cast<float>(seconds);
    s.force = vec4(w.params.touch, static_cast<float>(double{w.params.largestDrop} * kMicrolitre), 0.0F, 0.0F);
    FlowStep f = w.stepOf(inputs, s, seconds);
    for (double& since : w.sinceTurn) since += seconds;
    w.phase = (w.phase + 1) % DRY_EVERY;
    f.dryPhase = w.phase;
    f.dries = static_cast<float>(double{w.params.evaporation} * w.sinceTurn[w.phase]);
    w.sinceTurn[w.phase] = 0;

    if (!inputs.positions.empty()) {
        std::vector<vec4> at;
        at.reserve(w.mesh.rest.size());
        for (const uint32_t k : w.mesh.given) at.emplace_back(inputs.positions[k], 0.0F);
        w.device->writeAll<vec4>(w.point, at);
        w.moved = true;
    }
    if (w.moved) {
        w.device->run(w.basis, f, {&w.skin, &w.point, &w.frames}, f.triangles);
        w.device->run(w.drive, f, {&w.begin, &w.footprint, &w.weight, &w.frames, &w.driven}, f.places);
        w.moved = false;
    }
    w.device->fill(w.counter, 0);
    if (!w.births.empty()) {
        w.device->write(w.birth, std::as_bytes(std::span(w.births)));
        w.device->run(w.born, f, {&w.grid->cellStart(), &w.drops.id, &w.birth, &w.drop, &w.motion, &w.counter}, f.births);
        w.births.clear();
    }
    w.device->run(w.place, f, {&w.drops.id, &w.frames, &w.drop, &w.motion, &w.drops.positionNext, &w.drops.velocityNext}, f.count);
    if (Status sorted = w.grid->build(s, w.drops); !sorted) return sorted;
    SolveFigures none;
    FluidParams unused;
    const Buffer nothing;
    StepContext context{.device = *w.device,
                        .fluid = unused,
                        .params = s,
                        .grid = *w.grid,
                        .particles = w.drops,
                        .solve = none,
                        .stats = nothing,
                        .build = {},
                        .pushSamples = {},
                        .planes = nothing,
                        .boundary = {},
                        .forces = {}};
    w.device->run(w.name, f, {&w.drops.id, &w.names, &w.sortedOf}, f.count);
    const uint32_t threads = w.grid->pairThreads();
    const Buffer& neighbors = w.grid->neighbors();
    w.meet.run(context, s, {&neighbors, &w.drops.position, &w.drops.velocity, &w.names, &w.into}, threads);
    w.gather.run(context, s, {&neighbors, &w.drops.position, &w.drops.velocity, &w.names, &w.into, &w.merged, &w.shift}, threads);
    w.device->run(w.merge, f, {&w.grid->cellStart(), &w.drops.id, &w.sortedOf, &w.into, &w.drop, &w.counter}, f.count);
    w.device->run(w.law, f, {&w.drops.id, &w.skin, &w.frames, &w.driven, &w.merged, &w.film, &w.drop, &w.motion}, f.count);
    w.device->run(w.walk, f, {&w.drops.id, &w.skin, &w.frames, &w.shift, &w.drop, &w.motion}, f.count);
    w.device->run(w.paint, f, {&w.drops.id, &w.skin, &w.frames, &w.motion, &w.film, &w.drop}, f.count);
    if (f.dries > 0) w.device->run(w.dry, f, {&w.skin, &w.frames, &w.film, &w.counter}, (f.triangles + DRY_EVERY - 1) / DRY_EVERY);
    w.device->run(w.leave, f, {&w.drops.id, &w.frames, &w.motion, &w.drop, &w.counter, &w.left}, f.count);
    w.takeCounters();
    return ok();
}

std::vector<SkinDrop> SurfaceFlow::drops() const {
    const Impl& w = *impl_;
    const auto state = w.device->readAll<uint32_t>(w.drop, size_t{w.count()} * DROP_UINTS);
    const auto motion = w.device->readAll<vec4>(w.motion, w.count());
    const auto frames = w.device->readAll<vec4>(w.frames, 5 * w.mesh.triangleCount());
    std::vector<SkinDrop> all;
    for (uint32_t k = 0; k < w.count(); ++k) {
        const uint32_t* d = &state[size_t{k} * DROP_UINTS];
        if (d[DROP_VOLUME] == 0) continue;
        const SkinPoint at{d[DROP_TRIANGLE] & (DROP_LEFT - 1), std::bit_cast<float>(d[DROP_B1]), std::bit_cast<float>(d[DROP_B2])};
        const vec4* basis = &frames[5 * size_t{at.triangle}];
        all.push_back({k, at, vec3(basis[0]) + at.b1 * vec3(basis[1]) + at.b2 * vec3(basis[2]), vec3(motion[k]), d[DROP_VOLUME] * 1.0e-15,
                       double{motion[k].w}});
    }
    return all;
}

std::vector<LeftDrop> SurfaceFlow::takeLeft() {
    std::vector<LeftDrop> taken;
    taken.swap(impl_->told->gone);
    return taken;
}

std::vector<float> SurfaceFlow::film(uint32_t triangle) const {
    const Impl& w = *impl_;
    const uint32_t first = w.firstCell[triangle], cells = w.firstCell[triangle + 1] - first;
    std::vector<uint32_t> volume(cells);
    w.device->read(w.film, std::as_writable_bytes(std::span(volume)), first * sizeof(uint32_t));
    vec4 frame;
    w.device->read(w.frames, std::as_writable_bytes(std::span(&frame, 1)), 5 * size_t{triangle} * sizeof(vec4));
    std::vector<float> thickness;
    thickness.reserve(cells);
    for (const uint32_t v : volume) thickness.push_back(static_cast<float>(v * 1.0e-15 * cells / std::max(double{frame.w}, 1.0e-30)));
    return thickness;
}

SurfaceFlow::Ledger SurfaceFlow::ledger() const {
    Impl& w = *impl_;
    w.device->finish();
    w.device->poll();
    Ledger l{
        .added = w.added, .left = w.told->left, .evaporated = w.told->evaporated, .refused = w.told->refused, .merges = w.told->merges};
    const auto state = w.device->readAll<uint32_t>(w.drop, size_t{w.count()} * DROP_UINTS);
    for (size_t k = 0; k < w.count(); ++k) l.drops += state[k * DROP_UINTS + DROP_VOLUME];
    for (const FlowBirth& b : w.births) l.drops += b.volume;  // with the next step
    for (const uint32_t v : w.device->readAll<uint32_t>(w.film, w.firstCell.back())) l.film += v;
    return l;
}

}  // namespace rivulet
