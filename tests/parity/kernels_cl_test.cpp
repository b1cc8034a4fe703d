// Every kernel that scenes run on cl, one dispatch at a time: from the same memory the cpu computes the same result. Kernels over
// neighbours have another form on the cpu (lists, not cells); SimParity, ForcesParity, FoamParity and BodiesParity compare their results
// after a step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "engine/core/file.h"
#include "fluid/session/session.h"
#include "tests/parity/devices.h"

namespace rivulet::kernels_cl_test {
namespace {

// Results of a kernel over all its dispatches.
struct Compared {
    size_t dispatches = 0, words = 0, apart = 0;
    double worst = 0;  // of the largest value in the buffer
};

// Device cl, which repeats each dispatch on the cpu.
class TwinDevice final : public Device {
  public:
    TwinDevice(Device& cl, Device& cpu) : cl_(cl), cpu_(cpu) {}
    Backend backend() const override { return cl_.backend(); }
    const DeviceInfo& info() const override { return cl_.info(); }
    Result<Kernel> kernel(std::string_view path, std::span<const Define> defines) override {
        const Result<Kernel> made = cl_.kernel(path, defines);
        if (!made || known_.contains(made->index)) return made;
        std::vector<Define> same;
        for (const Define& d : defines)
            if (d.name != "LOCAL_SIZE") same.push_back(d);
        const Result<Kernel> other = cpu_.kernel(path, same);
        known_[made->index] = {std::string(path), other ? std::optional(*other) : std::nullopt};
        return made;
    }
    std::vector<std::string> kernels() const override { return cl_.kernels(); }
    Result<Buffer> allocate(size_t bytes) override { return cl_.allocate(bytes); }
    void release(uint64_t handle, size_t bytes) override { cl_.release(handle, bytes); }
    void write(Buffer& to, std::span<const std::byte> bytes, size_t offset) override { cl_.write(to, bytes, offset); }
    void read(const Buffer& from, std::span<std::byte> bytes, size_t offset) override { cl_.read(from, bytes, offset); }
    void fill(Buffer& to, uint32_t word) override { cl_.fill(to, word); }
    void copy(const Buffer& from, Buffer& to, size_t bytes) override { cl_.copy(from, to, bytes); }
    void readLater(const Buffer& from, size_t bytes, std::function<void(std::span<const std::byte>)> then, size_t offset) override {
        cl_.readLater(from, bytes, std::move(then), offset);
    }
    void poll() override { cl_.poll(); }
    void finish() override { cl_.finish(); }
    std::vector<PassTime> takeTimes() override { return cl_.takeTimes(); }
    size_t bytesAllocated() const override { return cl_.bytesAllocated(); }
    void dispatch(Kernel kernel, std::span<const std::byte> params, std::span<const Buffer* const> buffers, uint32_t threads) override;

    std::map<std::string, Compared> all;  // by path
    std::set<std::string> alone;          // kernels that the cpu does not have, or has in another form

  private:
    struct Known {
        std::string path;
        std::optional<Kernel> cpu;
    };
    Device &cl_, &cpu_;
    std::map<uint32_t, Known> known_;
};

// Kernels that append to a list in the order of their threads: the order differs from run to run, the set of entries does not.
const std::set<std::string> kAsTheyCome = {"fluid/surface/foam_born", "fluid/surface/foam_move", "flow/leave", "flow/brim",
                                           "flow/map_touch"};

// Sorts the words of a buffer by their value as floats, so that buffers with another order of entries can be compared.
std::vector<std::byte> sortedWords(std::span<const std::byte> bytes) {
    std::vector<int32_t> words(bytes.size() / 4);
    std::memcpy(words.data(), bytes.data(), 4 * words.size());
    std::sort(words.begin(), words.end(), [](int32_t a, int32_t b) { return (a < 0 ? INT32_MIN - a : a) < (b < 0 ? INT32_MIN - b : b); });
    std::vector<std::byte> sorted(4 * words.size());
    std::memcpy(sorted.data(), words.data(), sorted.size());
    return sorted;
}

// True if the cpu has another form of the kernel: lists of neighbours where a GPU has cells.
bool looksThroughNeighbours(const std::string& path) {
    const Result<std::string> text = readFile(std::string(RIVULET_SOURCE_DIR) + "/shaders/" + path + ".kernel");
    EXPECT_TRUE(text) << path;
    return text && (text->find("NEIGHBOR_TYPE") != std::string::npos || text->find("NEIGHBORS_KEPT") != std::string::npos);
}

void compare(std::span<const std::byte> there, std::span<const std::byte> here, Compared& c) {
    double largest = 0;
    const size_t words = here.size() / 4;
    const auto word = [](std::span<const std::byte> bytes, size_t i) {
        uint32_t w = 0;
        std::memcpy(&w, bytes.data() + 4 * i, 4);
        return w;
    };
    const auto value = [&](std::span<const std::byte> bytes, size_t i) {
        float f = 0;
        std::memcpy(&f, bytes.data() + 4 * i, 4);
        return double{f};
    };
    for (size_t i = 0; i < words; ++i)
        if (std::isfinite(value(here, i))) largest = std::max(largest, std::abs(value(here, i)));
    for (size_t i = 0; i < words; ++i) {
        ++c.words;
        if (word(there, i) == word(here, i)) continue;
        const double a = value(there, i), b = value(here, i);
        if (std::isnan(a) && std::isnan(b)) continue;
        const double off = std::isfinite(a) && std::isfinite(b) && largest > 0 ? std::abs(a - b) / largest : 1.0;
        // Counts and indices read as floats are nearly 0.
        const bool counts = word(there, i) < (1U << 23U) && word(here, i) < (1U << 23U);
        c.worst = std::max(c.worst, counts ? 1.0 : off);
        if (counts || off > 1.0e-5) ++c.apart;
    }
}

void TwinDevice::dispatch(Kernel kernel, std::span<const std::byte> params, std::span<const Buffer* const> buffers, uint32_t threads) {
    const Known& known = known_.at(kernel.index);
    if (!known.cpu || looksThroughNeighbours(known.path)) {
        alone.insert(known.path);
        cl_.dispatch(kernel, params, buffers, threads);
        return;
    }
    std::vector<Buffer> copies;
    std::map<uint64_t, size_t> of;  // a buffer may be bound twice
    std::vector<const Buffer*> bound;
    std::vector<size_t> at;
    for (const Buffer* b : buffers) {
        if (b == nullptr) {
            at.push_back(SIZE_MAX);
            continue;
        }
        const auto [found, fresh] = of.try_emplace(b->handle(), copies.size());
        if (fresh) {
            copies.push_back(std::move(*cpu_.allocate(b->bytes())));
            cpu_.writeAll<std::byte>(copies.back(), cl_.readAll<std::byte>(*b, b->bytes()));
        }
        at.push_back(found->second);
    }
    for (const size_t k : at) bound.push_back(k == SIZE_MAX ? nullptr : &copies[k]);
    cl_.dispatch(kernel, params, buffers, threads);
    cpu_.dispatch(*known.cpu, params, bound, threads);
    Compared& c = all[known.path];
    ++c.dispatches;
    for (size_t k = 0; k < at.size(); ++k) {
        if (at[k] == SIZE_MAX ||
            std::find(at.begin(), at.begin() + static_cast<std::ptrdiff_t>(k), at[k]) != at.begin() + static_cast<std::ptrdiff_t>(k))
            continue;
        std::vector<std::byte> there = cl_.readAll<std::byte>(*buffers[k], buffers[k]->bytes());
        std::vector<std::byte> here = cpu_.readAll<std::byte>(copies[at[k]], buffers[k]->bytes());
        if (kAsTheyCome.contains(known.path)) {
            there = sortedWords(there);
            here = sortedWords(here);
        }
        compare(there, here, c);
    }
}

// Not compared: cells, whose order differs from run to run until they are sorted (SortTest), and the progress of a solver, which only a GPU
// has (SolverStops).
const std::set<std::string> kElsewhere = {"fluid/grid/cell_count",  "fluid/grid/cell_scatter",      "fluid/grid/cell_sort",
                                          "fluid/grid/reorder",     "fluid/grid/scan_apply",        "fluid/grid/scan_blocks",
                                          "fluid/grid/scan_reduce", "fluid/methods/solver_progress"};

class KernelsOfCl : public testing::Test {
  protected:
    void SetUp() override {
        Result<TestGpu> gpu = makeTestGpu("cl");
        if (!gpu) GTEST_SKIP() << gpu.error().message;
        gpu_ = std::move(*gpu);
        cpu_ = makeTestCpu();
        twin_ = std::make_unique<TwinDevice>(*gpu_.device, *cpu_);
    }
    // Some frames of a scene.
    void run(const char* name, const std::vector<std::string>& set, int frames = 3) {
        SCOPED_TRACE(name);
        auto scene = loadScene(name, set);
        ASSERT_TRUE(scene) << scene.error().message;
        auto session = Session::create(*scene, *twin_, {});
        ASSERT_TRUE(session) << session.error().message;
        for (int f = 0; f < frames; ++f) (*session)->step(1.0 / 60, true);
        EXPECT_EQ((*session)->world().stats().nan, 0U);
    }
    TestGpu gpu_;
    std::unique_ptr<Device> cpu_;
    std::unique_ptr<TwinDevice> twin_;
};

TEST_F(KernelsOfCl, EachDispatchIsTheCpus) {
    run("dam_break", {"fluid.spacing=0.05", "fluid.method=wcsph", "fluid.forces.adhesion=1"});
    run("dam_break", {"fluid.spacing=0.05", "fluid.method=wcsph_thesis", "fluid.forces.normals=thesis", "fluid.forces.tension=0.07"});
    run("dam_break", {"fluid.spacing=0.05", "fluid.method=dfsph", "fluid.collision.walls=no-slip"});
    run("dam_break",
        {"fluid.spacing=0.05", "fluid.method=pbf", "fluid.foam.most=500", "fluid.ellipsoids=true", "fluid.forces.vorticity=0.1"});
    run("honey", {"fluid.spacing=0.03"});
    run("oil_on_water", {"fluid.spacing=0.05"});
    run("wave_tank", {"fluid.spacing=0.06"});
    run("cases/couette.json", {"fluid.supportSpacings=2.3", "fluid.forces.viscosity=implicit", "fluid.forces.viscosityTolerance=1e-3"});
    run("paddle_wheel", {"fluid.spacing=0.025", "colliders.0.resolution=32", "fluid.foam.most=500"});
    run("waving_sheet", {"fluid.spacing=0.05", "colliders.0.resolution=24"});
    run("window_rain", {"flow.0.mapSize=64", "flow.0.liquid.capacity=2048", "flow.0.liquid.filmCell=0.003"}, 6);
    run("crying_thesis", {"flow.0.mapSize=64"}, 6);
    // A GPU fuses multiplications and additions otherwise than the cpu. Measured on an H100: of these kernels' words so many are apart,
    // because a place lies on the edge of a cell of film, or a wall is just as far as another.
    const std::map<std::string, double> onGpus = {{"flow/map_taps", 5.0e-5}, {"fluid/solids/near_walls_moving", 1.0e-6}};
    for (const auto& [path, c] : twin_->all) {
        const auto known = onGpus.find(path);
        const double most = gpu_.device->info().software || known == onGpus.end() ? 0.0 : known->second * static_cast<double>(c.words);
        EXPECT_LE(static_cast<double>(c.apart), most)
            << path << ": of " << c.words << " words in " << c.dispatches << " dispatches, at worst by " << c.worst;
    }
    EXPECT_GE(twin_->all.size(), 50U) << "kernels that these scenes run";
    for (const std::string& path : twin_->alone)
        EXPECT_TRUE(kElsewhere.contains(path) || looksThroughNeighbours(path)) << path << " is not compared";
}

}  // namespace
}  // namespace rivulet::kernels_cl_test
