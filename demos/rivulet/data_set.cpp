#include "demos/rivulet/data_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <system_error>

#include "engine/core/file.h"
#include "engine/core/param_list.h"
#include "engine/core/param_value.h"

namespace rivulet {

namespace {

constexpr size_t kLeastChunk = 1024, kMostChunk = 65536;  // particles

#ifdef RIVULET_HDF5
constexpr auto kCreateHdf5 = createHdf5;
#else
constexpr Result<DataFile> (*kCreateHdf5)(const std::string&, size_t) = nullptr;
#endif
constexpr DataSetFormat kRows[] = {
    {"hdf5", "all frames in one HDF5 file, which is netCDF-4, too; for h5py and xarray", "h5", true, kCreateHdf5,
     "this program was built without HDF5; install libhdf5-dev and build it again, or use --format zarr"},
    {"zarr", "all frames in one folder of compressed chunks (Zarr version 2); for zarr-python and xarray", "zarr", false, createZarr, ""},
};
constexpr Table<DataSetFormat> kTable{kRows};

const DataAxis& xyz() {
    static const DataAxis axis{"xyz", 3, "xyz"};
    return axis;
}

// Items in the order `order`, their first `parts` components.
std::vector<float> componentsOf(const std::vector<vec4>& from, std::span<const uint32_t> order, int first, int parts) {
    std::vector<float> to;
    to.reserve(from.size() * static_cast<size_t>(parts));
    for (const uint32_t i : order)
        for (int k = first; k < first + parts; ++k) to.push_back(from[i][k]);
    return to;
}

std::vector<uint32_t> inOrder(size_t count) {
    std::vector<uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0U);
    return order;
}

}  // namespace

const Table<DataSetFormat>& dataSetFormats() { return kTable; }

size_t bytesOf(DataType type) { return type == DataType::real64 ? 8 : 4; }

size_t DataVariable::itemBytes() const {
    size_t bytes = bytesOf(type);
    for (const DataAxis& axis : axes) bytes *= axis.length;
    return bytes;
}

std::string jsonText(const std::string& text) { return valueText(text); }

std::vector<DataAttribute> parametersOf(SceneFile scene) {
    std::vector<DataAttribute> all;
    for (ParamEntry& entry : listParams([&scene](ParamVisitor& v) { scene.visit(v); }))
        if (entry.kind == ParamEntry::Kind::value && entry.path.find("[]") == std::string::npos)
            all.push_back({std::move(entry.path), std::move(entry.text)});
    return all;
}

Result<DataSetWriter> DataSetWriter::open(const DataSetFormat& format, const std::string& path) {
    if (format.create == nullptr) return failed(format.missing);
    std::error_code error;
    const std::filesystem::file_status there = std::filesystem::symlink_status(path, error);
    if (std::filesystem::exists(there) && (!format.replaces || std::filesystem::is_directory(path, error)))
        return failed(fmt::format("{} exists; remove it, or choose another folder by --out", path));
    if (Status writable = checkWritable(path); !writable) return writable.error();
    return DataSetWriter(format, path);
}

Status DataSetWriter::put(const DataVariable& variable, size_t count, const void* values) {
    if (!variable.items.empty()) {
        size_t& length = lengths_[variable.items];
        length = std::max(length, count);
    }
    return file_->put(variable, frames(), count, values);
}

Status DataSetWriter::add(RecordedFrame frame) {
    const size_t count = frame.position.size();
    if (!file_) {
        Result<DataFile> file = format_->create(path_, std::clamp(std::max(count, expected_), kLeastChunk, kMostChunk));
        if (!file) return file.error();
        file_ = std::make_unique<DataFile>(std::move(*file));
    }
    std::vector<uint32_t> order = inOrder(count);
    std::ranges::sort(order, {}, [&frame](uint32_t i) { return frame.id[i]; });
    std::vector<uint32_t> ids;
    ids.reserve(count);
    for (const uint32_t i : order) ids.push_back(frame.id[i]);

    Status done = ok();
    const auto write = [&](const DataVariable& variable, size_t items, const void* values) {
        if (done) done = put(variable, items, values);
    };
    const auto vectors = [&](const DataVariable& variable, const std::vector<vec4>& from, std::span<const uint32_t> of, int first = 0) {
        const int parts = variable.axes.empty() ? 1 : static_cast<int>(variable.axes[0].length);
        if (!from.empty() || variable.items == "particle") write(variable, from.size(), componentsOf(from, of, first, parts).data());
    };
    const auto particles = static_cast<uint32_t>(count), foam = static_cast<uint32_t>(frame.foam.size());
    write({"time", DataType::real64, "", {}, "s", "simulated time", {{"standard_name", "\"time\""}, {"axis", "\"T\""}}}, 1, &frame.time);
    write({"count", DataType::whole32, "", {}, "1", "number of particles in the frame"}, 1, &particles);
    vectors({"position", DataType::real32, "particle", {xyz()}, "m", "position relative to fluid.origin, +Y up"}, frame.position, order);
    vectors({"velocity", DataType::real32, "particle", {xyz()}, "m s-1", "velocity"}, frame.velocity, order);
    vectors({"relative_density", DataType::real32, "particle", {}, "1", "density divided by the rest density of the particle's liquid"},
            frame.position, order, 3);
    write({"id", DataType::whole32, "particle", {}, "1", "number of the particle, constant from frame to frame"}, count, ids.data());
    if (!frame.absorption.empty())
        vectors({"absorption", DataType::real32, "particle", {{"rgb", 3, "rgb"}}, "m-1", "absorption of red, green and blue light"},
                frame.absorption, order);
    for (size_t k = 0; k < kMostAttributes; ++k)
        if (!frame.attributes[k].empty())
            vectors({fmt::format("attribute_{}", k),
                     DataType::real32,
                     "particle",
                     {{"xyzw", 4, "xyzw"}},
                     "1",
                     fmt::format("value of fluid.attributes[{}]", k)},
                    frame.attributes[k], order);
    if (foam > 0) {
        const std::vector<uint32_t> all = inOrder(foam);
        std::vector<float> sizes;
        std::vector<uint32_t> kinds;
        sizes.reserve(foam);
        kinds.reserve(foam);
        for (const vec4& v : frame.foamVelocity) {
            kinds.push_back(static_cast<uint32_t>(std::ceil(v.w)) - 1);  // particle_view.h: size plus kind
            sizes.push_back(v.w - static_cast<float>(kinds.back()));
        }
        vectors({"foam_position", DataType::real32, "foam", {xyz()}, "m", "position of spray, foam and bubbles"}, frame.foam, all);
        vectors({"foam_velocity", DataType::real32, "foam", {xyz()}, "m s-1", "velocity of spray, foam and bubbles"}, frame.foamVelocity,
                all);
        vectors({"foam_life", DataType::real32, "foam", {}, "s", "remaining life of spray, foam and bubbles"}, frame.foam, all, 3);
        write({"foam_size", DataType::real32, "foam", {}, "1", "size of spray, foam and bubbles relative to the largest"}, foam,
              sizes.data());
        write({"foam_kind", DataType::whole32, "foam", {}, "1", "1: spray, 2: foam, 3: bubble"}, foam, kinds.data());
        write({"foam_count", DataType::whole32, "", {}, "1", "number of foam particles in the frame"}, 1, &foam);
    }
    if (!frame.places.empty()) {
        for (mat4& place : frame.places) place = glm::transpose(place);  // rows first
        write({"solid_pose",
               DataType::real32,
               "solid",
               {{"row", 4}, {"column", 4}},
               "1",
               "matrix from the frame of a solid that moves to that of the scene, m"},
              frame.places.size(), frame.places.data());
    }
    if (!done) return done;
    times_.push_back(frame.time);
    particles_ += count;
    return done;
}

Status DataSetWriter::close(std::vector<DataAttribute> attributes) {
    std::vector<DataAttribute> all = {{"Conventions", "\"CF-1.10\""}, {"source", jsonText(fmt::format("Rivulet {}", RIVULET_VERSION))}};
    all.insert(all.end(), std::make_move_iterator(attributes.begin()), std::make_move_iterator(attributes.end()));
    return file_->close(frames(), lengths_, all);
}

}  // namespace rivulet
