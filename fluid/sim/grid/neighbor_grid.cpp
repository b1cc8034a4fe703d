#include "fluid/sim/grid/neighbor_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/compute/device_cpu.h"
#include "engine/core/assert.h"
#include "fluid/sim/kernels/cpu_grid.h"
#include "shaders/fluid/grid/kept_pairs.h"
#include "shaders/fluid/grid/linked_list.h"
#include "shaders/fluid/grid/scan_params.h"

namespace rivulet {

namespace {

// Cells above this would take more memory than the particles of any scene that fits one device.
constexpr double kMostCells = 64.0e6;
// A grid that may follow its particles does so if it would have more cells than this, and than this for each particle. A full box has a
// twelfth of a cell for each.
constexpr double kFewCells = 4.0e6, kCellsEach = 8;
// Of the neighbour lists of the cpu: a group names the first of its own by 32 bits.
constexpr uint64_t kMostEntries = UINT32_MAX;

// Takes the first Error of several allocations.
struct Allocator {
    Device& device;
    Status status = ok();
    Buffer operator()(size_t bytes) {
        if (!status) return {};
        Result<Buffer> buffer = device.allocate(bytes);
        if (!buffer) {
            status = buffer.error();
            return {};
        }
        return std::move(*buffer);
    }
};

}  // namespace

struct NeighborGrid::Impl {
    Device* device = nullptr;
    vec3 origin{0.0F};
    float h = 0, margin = 1;
    ivec3 cells{0};  // padded
    vec3 scale{0.0F}, period{0.0F};
    uint32_t count = 0;
    Bounds inside;
    bool window = false;
    uint32_t cellRoom = 0;  // totalCells() that memory is for
    PairTraits traits;
    Buffer cellStart, cellOf;

    // CPU
    uint32_t chunks = 1;
    uint32_t groupCount = 0, fluidGroups = 0;
    uint32_t listCapacity = 0;
    uint32_t awakeSlots = 0;  // slots before those of sleeping particles, as last sorted
    bool sortAsleep = true;   // the next sort sorts sleeping particles too
    bool listed = false;      // some lists were built
    std::shared_ptr<const void> sleepers;
    bool idsBehind = false;  // the ids of sleeping particles are sorted in one of the two copies only
    Buffer x, y, z, histogram, segmentSum, groups, list, listCursor, lists;
    Kernel sortCount, sortSegments, sortOffsets, sortScatter, neighborList;

    // GPU
    Buffer cellCounts, rank, order, blockSum;
    bool given = false;  // cellOf is the next build's
    Kernel cellCount, cellCountGiven, scanReduce, scanBlocks, scanApply, cellScatter, cellSort, reorder, cellLink;

    bool onCpu() const { return device->backend() == Backend::cpu; }
    uint32_t coarseCells() const {
        return static_cast<uint32_t>(cells.x) * static_cast<uint32_t>(cells.y) * static_cast<uint32_t>(cells.z);
    }
    uint32_t sortedCells() const { return onCpu() ? 2 * coarseCells() : coarseCells(); }
    uint32_t totalCells() const { return traits.samples > 0 ? 2 * sortedCells() : sortedCells(); }
    uint32_t asleepCells() const { return traits.sleeps ? sortedCells() : 0; }
    uint32_t firstSample() const { return count - traits.samples; }
    Status allocate();
    Status allocateCells();
    Status follow(Bounds wanted);
    Status findKernels();
    CpuGridJob job(Particles& p) const;
    Status growLists(uint64_t needed);
    Status buildCpu(const StepParams& params, Particles& p);
    void buildGroups();
    void buildGpu(const StepParams& params, Particles& p);
    void buildLinked(const StepParams& params, Particles& p);
};

Status NeighborGrid::Impl::allocate() {
    Allocator take{*device};
    const size_t sorted = totalCells();
    if (traits.linked) {
        cellStart = take((NEXT_OF(sorted, count)) * sizeof(uint32_t));
        cellCounts = take(sorted * sizeof(uint32_t));
        return take.status;
    }
    if (Status cellsFit = allocateCells(); !cellsFit) return cellsFit;
    cellOf = take(size_t{count} * sizeof(uint32_t));
    if (onCpu()) {
        for (Buffer* b : {&x, &y, &z}) *b = take((size_t{count} + 8) * sizeof(float));
        segmentSum = take(kScanSegments * sizeof(uint32_t));
        listCursor = take(sizeof(uint64_t));
        lists = take(sizeof(CpuNeighborLists));
        const uint64_t first = std::min(uint64_t{count} * 14 + 64 * kListRegion / 8, kMostEntries);
        list = take(first * sizeof(uint32_t));
        listCapacity = static_cast<uint32_t>(first);
    } else {
        rank = take(size_t{count} * sizeof(uint32_t));
        order = take(size_t{count} * sizeof(uint32_t));
    }
    return take.status;
}

// What has a size of the number of cells. On an Error all of it stays as it was.
Status NeighborGrid::Impl::allocateCells() {
    Allocator take{*device};
    const size_t sorted = totalCells();
    const size_t counts = sorted + 4 + asleepCells();
    const bool keeps = traits.keeps && !onCpu() && !traits.repeats && !glm::any(traits.periodic);
    const size_t kept = keeps ? size_t{KEPT_ROWS} * KEPT_WORDS * count : 0;
    Buffer starts = take((counts + kept) * sizeof(uint32_t)), held, lanes;
    if (onCpu()) {
        chunks = static_cast<uint32_t>(std::clamp(static_cast<CpuDevice*>(device)->threads(), 1, 16));
        held = take(chunks * (counts - 1) * sizeof(uint32_t));
        // A row's last group may be short: at most one such a row. A window may get other rows.
        const size_t rows = window ? count : sorted / (2 * static_cast<size_t>(cells.x));
        lanes = take((count / 8 + std::min<size_t>(count, rows) + 1) * sizeof(CpuGroup));
    } else {
        held = take(counts * sizeof(uint32_t));
        lanes = take((counts / SCAN_BLOCK + 1) * sizeof(uint32_t));
    }
    if (!take.status) return take.status;
    cellStart = std::move(starts);
    (onCpu() ? histogram : cellCounts) = std::move(held);
    (onCpu() ? groups : blockSum) = std::move(lanes);
    cellRoom = totalCells();
    return ok();
}

Status NeighborGrid::Impl::follow(Bounds wanted) {
    if (wanted.empty()) wanted = {inside.min, inside.min};
    wanted = {glm::clamp(wanted.min, inside.min, inside.max), glm::clamp(wanted.max, inside.min, inside.max)};
    const vec3 edge = 1.0F / glm::max(scale, vec3(1.0e-30F));
    const Bounds now{origin + 2.0F * edge, origin + (vec3(cells) - 2.0F) * edge};  // a cell more than has to be
    if (cellRoom > 0 && glm::all(glm::greaterThanEqual(wanted.min, now.min)) && glm::all(glm::lessThanEqual(wanted.max, now.max)))
        return ok();
    const double most = std::max(kFewCells, kCellsEach * count);
    ivec3 low, high;
    double wide = double{h};
    for (double all = most + 1; all > most; wide *= 1.1) {
        for (int k = 0; k < 3; ++k) {
            const double room = std::max(4 * wide, 0.1 * double{wanted.size()[k]});  // so that the next steps find it in place
            low[k] = static_cast<int>(std::floor(std::max(double{wanted.min[k]} - room - double{inside.min[k]}, 0.0) / wide)) - 2;
            high[k] = static_cast<int>(
                          std::ceil(std::min(double{wanted.max[k]} + room - double{inside.min[k]}, double{inside.size()[k]}) / wide)) +
                      2;
        }
        all = (onCpu() ? 2.0 : 1.0) * (traits.samples > 0 ? 2 : 1);
        for (int k = 0; k < 3; ++k) all *= high[k] - low[k] + 2;
        if (all <= most) break;
    }
    const ivec3 before = std::exchange(cells, high - low + 2);
    if (totalCells() > cellRoom)
        if (Status larger = allocateCells(); !larger) {
            cells = before;
            return larger;
        }
    for (int k = 0; k < 3; ++k) {
        scale[k] = static_cast<float>(1 / wide);
        origin[k] = static_cast<float>(double{inside.min[k]} + (low[k] - 1) * wide);
    }
    return ok();
}

Status NeighborGrid::Impl::findKernels() {
    struct Wanted {
        Kernel* kernel;
        const char* path;
        std::vector<Define> defines;
    };
    std::vector<Wanted> wanted;
    std::vector<Define> listDefines;
    if (glm::any(traits.periodic) || traits.repeats) listDefines.push_back({"PERIODIC", "1"});
    if (onCpu())
        wanted = {{&sortCount, "fluid/grid/cpu_sort_count", {}},
                  {&sortSegments, "fluid/grid/cpu_sort_segments", {}},
                  {&sortOffsets, "fluid/grid/cpu_sort_offsets", {}},
                  {&sortScatter, "fluid/grid/cpu_sort_scatter", {}},
                  {&neighborList, "fluid/grid/cpu_neighbor_list", listDefines}};
    else if (traits.linked)
        wanted = {{&cellLink, "fluid/grid/cell_link", traits.threadDefines()}};
    else {
        const std::vector<Define> threads = traits.threadDefines();
        const std::vector<Define> scanSize = {{"LOCAL_SIZE", std::to_string(SCAN_THREADS)}};
        std::vector<Define> givenDefines = threads;
        givenDefines.push_back({"GIVEN", "1"});
        std::vector<Define> countDefines = threads;
        if (traits.sleeps) countDefines.push_back({"SLEEP", "1"});
        if (traits.repeats) countDefines.push_back({"REPEATS", "1"});
        wanted = {{&cellCount, "fluid/grid/cell_count", countDefines}, {&cellCountGiven, "fluid/grid/cell_count", givenDefines},
                  {&scanReduce, "fluid/grid/scan_reduce", scanSize},   {&scanBlocks, "fluid/grid/scan_blocks", scanSize},
                  {&scanApply, "fluid/grid/scan_apply", scanSize},     {&cellScatter, "fluid/grid/cell_scatter", threads},
                  {&cellSort, "fluid/grid/cell_sort", threads},        {&reorder, "fluid/grid/reorder", threads}};
    }
    for (Wanted& w : wanted) {
        Result<Kernel> found = device->kernel(w.path, w.defines);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    return ok();
}

CpuGridJob NeighborGrid::Impl::job(Particles& p) const {
    CpuGridJob j{};
    j.originX = origin.x;
    j.originY = origin.y;
    j.originZ = origin.z;
    j.scaleX = scale.x;
    j.scaleY = scale.y;
    j.scaleZ = scale.z;
    j.periodX = period.x;
    j.periodY = period.y;
    j.periodZ = period.z;
    j.reach = h * margin;
    j.totalCells = totalCells();
    j.firstSample = firstSample();
    j.cellsX = cells.x;
    j.cellsY = cells.y;
    j.cellsZ = cells.z;
    j.count = sortAsleep ? count : awakeSlots;
    j.asleepCells = asleepCells();
    j.sortsAsleep = traits.sleeps && sortAsleep;
    j.repeats = traits.repeats;
    j.chunks = chunks;
    j.groupCount = groupCount;
    j.listCapacity = listCapacity;
    j.position = hostPointer<Float4>(p.positionNext);
    j.velocity = hostPointer<Float4>(p.velocityNext);
    j.id = hostPointer<uint32_t>(p.id);
    j.positionOut = hostPointer<Float4>(p.position);
    j.velocityOut = hostPointer<Float4>(p.velocity);
    j.idOut = hostPointer<uint32_t>(p.idNext);
    j.x = hostPointer<float>(x);
    j.y = hostPointer<float>(y);
    j.z = hostPointer<float>(z);
    j.cell = hostPointer<uint32_t>(cellOf);
    j.histogram = hostPointer<uint32_t>(histogram);
    j.segmentSum = hostPointer<uint32_t>(segmentSum);
    j.cellStart = hostPointer<uint32_t>(cellStart);
    j.groups = hostPointer<CpuGroup>(groups);
    j.list = hostPointer<uint32_t>(list);
    j.listCursor = hostPointer<uint64_t>(listCursor);
    return j;
}

// Groups of up to 8 consecutive particles that do not cross the end of a row.
void NeighborGrid::Impl::buildGroups() {
    const uint32_t* start = hostPointer<uint32_t>(cellStart);
    CpuGroup* group = hostPointer<CpuGroup>(groups);
    const size_t rowLength = 2 * static_cast<size_t>(cells.x), rows = totalCells() / rowLength;
    groupCount = fluidGroups = 0;
    for (size_t row = 0; row < rows; ++row) {
        if (row * rowLength == sortedCells()) fluidGroups = groupCount;
        const uint32_t end = start[(row + 1) * rowLength];
        for (uint32_t first = start[row * rowLength]; first < end; first += 8)
            group[groupCount++] = {first, std::min(8U, end - first), 0, 0, 0};
    }
    if (traits.samples == 0) fluidGroups = groupCount;
}

// Makes room for `needed` entries and a quarter more. On an Error the lists and their capacity stay as they were.
Status NeighborGrid::Impl::growLists(uint64_t needed) {
    if (needed > kMostEntries)
        return failed(
            fmt::format("the particles are packed so closely that their neighbour lists need {} entries, more than the {} that "
                        "there may be: enlarge the box or the spacing",
                        needed, kMostEntries));
    const uint64_t capacity = std::min(needed + needed / 4, kMostEntries);
    Result<Buffer> larger = device->allocate(capacity * sizeof(uint32_t));
    if (!larger) return noMemory("not enough memory for the neighbour lists: " + larger.error().message);
    list = std::move(*larger);
    listCapacity = static_cast<uint32_t>(capacity);
    return ok();
}

Status NeighborGrid::Impl::buildCpu(const StepParams& params, Particles& p) {
    CpuDevice& cpu = *static_cast<CpuDevice*>(device);
    auto run = [&](Kernel k, const CpuGridJob& j, uint32_t threads) { cpu.dispatch(k, std::as_bytes(std::span(&j, 1)), {}, threads); };
    if (!sortAsleep && std::exchange(idsBehind, false)) {
        // What sleeps stays in its slots, in both copies of the ids.
        const uint32_t* ids = hostPointer<uint32_t>(p.id);
        std::copy(ids + awakeSlots, ids + count, hostPointer<uint32_t>(p.idNext) + awakeSlots);
    }
    CpuGridJob j = job(p);
    run(sortCount, j, chunks);
    run(sortSegments, j, kScanSegments);
    run(sortOffsets, j, kScanSegments);
    run(sortScatter, j, chunks);
    if (cpu.interrupted()) return failed("the sort was interrupted");  // cells and groups may not match
    p.id.swap(p.idNext);
    awakeSlots = hostPointer<uint32_t>(cellStart)[totalCells() + 3];
    const bool sortedAll = sortAsleep;
    if (j.sortsAsleep) {
        sortAsleep = false;
        idsBehind = true;
        sleepers = std::make_shared<char>();
    }
    buildGroups();
    if (!std::exchange(listed, true)) {
        // A group of 8 particles of a liquid at rest lists about 15 (reach / spacing)^3 entries, and growLists adds a quarter. Too little
        // room costs a second pass.
        const double reach = double{h} * double{margin} / double{params.spacing};
        const double likely = std::min(15 * reach * reach * reach * groupCount, double{UINT32_MAX / 4});
        if (likely > listCapacity) (void)growLists(static_cast<uint64_t>(likely));
    }
    while (true) {
        *hostPointer<uint64_t>(listCursor) = 0;
        j = job(p);
        run(neighborList, j, groupCount);
        const uint64_t taken = *hostPointer<uint64_t>(listCursor);
        if (taken <= listCapacity) break;
        if (Status grown = growLists(taken); !grown) {
            p.id.swap(p.idNext);  // ids go with the newest state, which stays as it was
            sortAsleep = sortedAll;
            return grown;
        }
    }
    *hostPointer<CpuNeighborLists>(lists) = {hostPointer<CpuGroup>(groups), hostPointer<uint32_t>(list),
                                             hostPointer<CpuGroup>(groups) + fluidGroups};
    return ok();
}

void NeighborGrid::Impl::buildGpu(const StepParams& params, Particles& p) {
    device->fill(cellCounts, 0);
    if (traits.sleeps)
        device->run(cellCount, params, {&p.positionNext, &p.id, &cellCounts, &cellOf, &rank, &p.velocityNext}, count);
    else
        device->run(std::exchange(given, false) ? cellCountGiven : cellCount, params, {&p.positionNext, &p.id, &cellCounts, &cellOf, &rank},
                    count);
    const uint32_t counts = totalCells() + 4 + asleepCells();
    const ScanParams scan{counts, (counts + SCAN_BLOCK - 1) / SCAN_BLOCK, 0, 0};
    device->run(scanReduce, scan, {&cellCounts, &blockSum}, scan.blocks * SCAN_THREADS);
    device->run(scanBlocks, scan, {&blockSum}, SCAN_THREADS);
    device->run(scanApply, scan, {&cellCounts, &blockSum, &cellStart}, scan.blocks * SCAN_THREADS);
    device->run(cellScatter, params, {&cellStart, &cellOf, &rank, &order}, count);
    device->run(cellSort, params, {&cellStart, &p.id, &order}, totalCells() + asleepCells());
    device->run(reorder, params, {&order, &p.positionNext, &p.velocityNext, &p.id, &p.position, &p.velocity, &p.idNext}, count);
    p.id.swap(p.idNext);
}

// As in the thesis the state is in two copies that take turns; the lists are cleared as a whole, next ones with them.
void NeighborGrid::Impl::buildLinked(const StepParams& params, Particles& p) {
    p.position.swap(p.positionNext);
    p.velocity.swap(p.velocityNext);
    device->fill(cellStart, LIST_END);
    device->fill(cellCounts, 0);
    device->run(cellLink, params, {&p.position, &cellStart, &cellCounts}, count);
}

std::vector<Define> PairTraits::threadDefines() const {
    std::vector<Define> d;
    if (linked) d.push_back({"LINKED_LIST", "1"});
    if (workGroup > 0) d.push_back({"LOCAL_SIZE", std::to_string(workGroup)});
    return d;
}

std::vector<Define> PairTraits::defines() const {
    std::vector<Define> d = threadDefines();
    if (matter) d.push_back({"MATTER", "1"});
    if (glm::any(periodic) || repeats) d.push_back({"PERIODIC", "1"});
    if (repeats) d.push_back({"REPEATS", "1"});
    if (asleepRows) d.push_back({"SLEEP", "1"});
    return d;
}

std::vector<Define> PairTraits::wallDefines(std::vector<Define> extra) const {
    if (!walls) extra.push_back({"OPEN", "1"});
    return extra;
}

namespace {

double cellsOf(const Bounds& inside, float h) {
    const vec3 size = inside.size() / h;
    return (std::ceil(double{size.x}) + 3) * (std::ceil(double{size.y}) + 3) * (std::ceil(double{size.z}) + 3);
}

bool followsParticles(const Bounds& inside, float h, double count, const PairTraits& traits) {
    return traits.follows && !glm::any(traits.periodic) && !traits.linked && cellsOf(inside, h) > std::max(kFewCells, kCellsEach * count);
}

}  // namespace

Status NeighborGrid::checkCells(const Bounds& inside, float h, double count, const PairTraits& traits) {
    const double cells = cellsOf(inside, h);
    if (cells <= kMostCells || followsParticles(inside, h, count, traits)) return ok();
    return badInput(
        fmt::format("the box of {:.3g} x {:.3g} x {:.3g} m would need {:.3g} cells of {:.3g} m: use a spacing of at least {:.3g} m there",
                    inside.size().x, inside.size().y, inside.size().z, cells, h, h / 2 * std::cbrt(cells / kMostCells)));
}

Result<NeighborGrid> NeighborGrid::create(Device& device, const Bounds& inside, float h, uint32_t count, const PairTraits& traits) {
    ASSERT(!inside.empty() && h > 0, "give the grid bounds with a volume and a positive support radius");
    ASSERT(!traits.repeats || !(traits.linked || traits.follows || glm::any(traits.periodic)), "a grid that repeats has no bounds");
    ASSERT(!traits.linked || (device.backend() != Backend::cpu && traits.samples == 0 && !glm::any(traits.periodic)),
           "linked lists are for a GPU, without samples and periodic axes");
    auto impl = std::make_unique<Impl>();
    impl->device = &device;
    impl->h = h;
    impl->count = count;
    impl->traits = traits;
    const vec3 size = inside.size() / h;
    impl->inside = inside;
    impl->window = followsParticles(inside, h, count, traits);
    if (impl->window) {
        if (Status s = impl->findKernels(); !s) return s.error();
        if (Status s = impl->follow({}); !s) return s.error();
        if (Status s = impl->allocate(); !s) return s.error();
        return NeighborGrid(std::move(impl));
    }
    if (Status few = checkCells(inside, h, count, traits); !few) return few.error();
    for (int k = 0; k < 3; ++k) {
        // One empty cell on every side: rows need no bounds checks.
        if (traits.repeats) {
            impl->cells[k] = std::max(static_cast<int>(std::ceil(size[k])), 2) + 2;
            impl->period[k] = static_cast<float>(impl->cells[k] - 2) * h;
            impl->scale[k] = 1.0F / h;
        } else if (traits.periodic[k]) {
            // As many cells as fit, so that they meet where the axis wraps.
            const auto n = static_cast<int>(std::floor(size[k] * 1.0001F));
            if (n < 2)
                return badInput(fmt::format("the box is {:.3g} m along the periodic axis {}, must be two support radii, {:.3g} m, or more",
                                            inside.size()[k], "xyz"[k], 2 * h));
            impl->cells[k] = n + 2;
            impl->period[k] = inside.size()[k];
            impl->scale[k] = static_cast<float>(n) / inside.size()[k];
        } else {
            // The last interior cell may be cut by the bounds; a wall's own coordinate still lies inside.
            impl->cells[k] = static_cast<int>(std::floor(size[k])) + 3;
            impl->scale[k] = 1.0F / h;
        }
        impl->origin[k] = inside.min[k] - 1.0F / impl->scale[k];
    }
    if (Status s = impl->findKernels(); !s) return s.error();
    if (Status s = impl->allocate(); !s) return s.error();
    return NeighborGrid(std::move(impl));
}

NeighborGrid::NeighborGrid(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
NeighborGrid::NeighborGrid(NeighborGrid&&) noexcept = default;
NeighborGrid& NeighborGrid::operator=(NeighborGrid&&) noexcept = default;
NeighborGrid::~NeighborGrid() = default;

void NeighborGrid::setCells(std::span<const uint32_t> cells) {
    ASSERT(cells.empty() || (cells.size() == impl_->count && impl_->cellCountGiven.index != UINT32_MAX), "give a GPU's sort a cell a slot");
    impl_->given = !cells.empty();
    if (impl_->given) impl_->device->writeAll<uint32_t>(impl_->cellOf, cells);
}

void NeighborGrid::fill(StepParams& params) const {
    const Impl& g = *impl_;
    params.gridOrigin = vec4(g.origin, 0.0F);
    params.gridScale = vec4(g.scale, 0.0F);
    params.period = vec4(g.period, 0.0F);
    for (int k = 0; k < 3; ++k) params.invPeriod[k] = g.period[k] > 0 ? 1.0F / g.period[k] : 0.0F;
    params.cellsX = g.cells.x;
    params.cellsY = g.cells.y;
    params.cellsZ = g.cells.z;
    params.cellCount = g.sortedCells();
    params.totalCells = g.totalCells();
    params.firstSample = g.firstSample();
    params.asleepSets = g.traits.sleeps ? 1 : 0;
    params.awakeSlots = g.sortAsleep || !g.onCpu() || !g.traits.sleeps ? g.count : g.awakeSlots;
}

bool NeighborGrid::isWindow() const { return impl_->window; }
Status NeighborGrid::follow(const Bounds& wanted) { return impl_->follow(wanted); }

Status NeighborGrid::build(const StepParams& params, Particles& particles) {
    if (impl_->onCpu()) return impl_->buildCpu(params, particles);
    if (impl_->traits.linked)
        impl_->buildLinked(params, particles);
    else
        impl_->buildGpu(params, particles);
    return ok();
}

void NeighborGrid::undo(Particles& particles) {
    if (impl_->traits.linked) {  // it takes them as they lie
        particles.position.swap(particles.positionNext);
        particles.velocity.swap(particles.velocityNext);
    } else {
        particles.id.swap(particles.idNext);
    }
    impl_->sortAsleep = true;
}

void NeighborGrid::sortAsleep() { impl_->sortAsleep = true; }
bool NeighborGrid::sortsAsleep() const { return impl_->sortAsleep || !impl_->onCpu(); }
std::shared_ptr<const void> NeighborGrid::sleepers() const { return sortsAsleep() ? nullptr : impl_->sleepers; }
uint32_t NeighborGrid::awakeSlots() const { return impl_->awakeSlots; }
void NeighborGrid::setMargin(float margin) { impl_->margin = margin; }
const Buffer& NeighborGrid::neighbors() const { return impl_->onCpu() ? impl_->lists : impl_->cellStart; }
const Buffer& NeighborGrid::cellStart() const { return impl_->cellStart; }
const Buffer& NeighborGrid::cellCounts() const { return impl_->cellCounts; }
uint32_t NeighborGrid::pairThreads() const { return impl_->onCpu() ? impl_->fluidGroups : impl_->count; }
uint32_t NeighborGrid::sampleThreads() const { return impl_->onCpu() ? impl_->groupCount - impl_->fluidGroups : impl_->traits.samples; }

}  // namespace rivulet
