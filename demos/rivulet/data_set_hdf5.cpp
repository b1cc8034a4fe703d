// HDF5 with dimension scales, as netCDF-4 has them: netCDF's own library, xarray and h5py read it.
#ifdef RIVULET_HDF5

#include <fmt/format.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "demos/rivulet/data_set.h"
#include "engine/core/new_file.h"
#include "engine/core/param_list.h"

namespace rivulet {

namespace {

constexpr unsigned kDeflateLevel = 4;     // of deflate
constexpr size_t kValuesPerChunk = 4096;  // of a variable with one value a frame

// Owns an identifier of the library. An invalid one makes each later call fail, so that one check at the end is enough.
class Handle {
  public:
    Handle() = default;
    Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
    Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(id_, other.id_);
        std::swap(close_, other.close_);
        return *this;
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() { (void)close(); }
    bool close() {
        const hid_t id = std::exchange(id_, H5I_INVALID_HID);
        return id < 0 || close_(id) >= 0;
    }
    operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): it is given to functions of C

  private:
    hid_t id_ = H5I_INVALID_HID;
    herr_t (*close_)(hid_t) = nullptr;
};

// The innermost reason of the last error; of an error of the system its text.
std::string reason() {
    std::string text;
    const auto look = [](unsigned, const H5E_error2_t* error, void* to) -> herr_t {
        *static_cast<std::string*>(to) = error->desc != nullptr ? error->desc : "";
        return 0;
    };
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, look, &text);
    constexpr std::string_view kMessage = "error message = '";
    if (const size_t at = text.find(kMessage); at != std::string::npos) {
        text.erase(0, at + kMessage.size());
        text.resize(std::min(text.find('\''), text.size()));
    }
    return text.empty() ? "the HDF5 library failed" : text;
}

hid_t typeOf(DataType type) {
    return type == DataType::real32 ? H5T_NATIVE_FLOAT : type == DataType::real64 ? H5T_NATIVE_DOUBLE : H5T_NATIVE_UINT32;
}

Handle textType() {
    Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type, H5T_VARIABLE);
    H5Tset_cset(type, H5T_CSET_UTF8);
    return type;
}

Handle space(std::span<const hsize_t> sizes, const hsize_t* limits = nullptr) {
    return {sizes.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), limits), H5Sclose};
}

bool addText(hid_t to, const std::string& name, const std::string& text) {
    const Handle type = textType(), one = space({}), attribute(H5Acreate2(to, name.c_str(), type, one, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    const char* bytes = text.c_str();
    return H5Awrite(attribute, type, &bytes) >= 0;
}

bool addNumbers(hid_t to, const std::string& name, std::span<const double> numbers) {
    const std::array<hsize_t, 1> size = {numbers.size()};
    const Handle extent = space(numbers.size() == 1 ? std::span<const hsize_t>() : size),
                 attribute(H5Acreate2(to, name.c_str(), H5T_NATIVE_DOUBLE, extent, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    return H5Awrite(attribute, H5T_NATIVE_DOUBLE, numbers.data()) >= 0;
}

// true and false become 1 and 0.
bool addAttribute(hid_t to, const DataAttribute& a) {
    if (a.json.starts_with('"')) return addText(to, a.name, plainText(a.json));
    if (a.json == "true" || a.json == "false") return addNumbers(to, a.name, std::array{a.json == "true" ? 1.0 : 0.0});
    std::vector<double> numbers;
    for (const char *at = a.json.data(), *end = at + a.json.size(); at < end;) {
        double number = std::numeric_limits<double>::quiet_NaN();
        const auto [next, error] = std::from_chars(at, end, number);
        if (error == std::errc()) numbers.push_back(number);
        at = error == std::errc() ? next : at + 1;
    }
    return addNumbers(to, a.name, numbers);
}

class Hdf5 {
  public:
    Hdf5(NewFile to, std::string path, size_t chunk) : to_(std::move(to)), path_(std::move(path)), chunk_(chunk) {}

    Status begin() {
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
        const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose), making(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
        // The newer layout of the file, in which an attribute may be longer than 64 KiB: a scene can be.
        const bool set = H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_LATEST) >= 0 &&
                         H5Pset_link_creation_order(making, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED) >= 0 &&
                         H5Pset_attr_creation_order(making, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED) >= 0;
        file_ = Handle(H5Fcreate(to_.name().c_str(), H5F_ACC_TRUNC, making, access), H5Fclose);
        return set && file_ >= 0 ? ok() : error();
    }

    Status put(const DataVariable& variable, size_t frame, size_t count, const void* values) {
        const auto [at, added] = arrays_.try_emplace(variable.name, Array{});
        Array& array = at->second;
        if (added && !create(variable, array)) return error();
        std::vector<hsize_t> from = {frame}, part = {1};
        array.size[0] = frame + 1;
        if (!variable.items.empty()) {
            from.push_back(0);
            part.push_back(count);
            array.size[1] = std::max<hsize_t>(array.size[1], count);
        }
        for (const DataAxis& axis : variable.axes) {
            from.push_back(0);
            part.push_back(axis.length);
        }
        if (H5Dset_extent(array.set, array.size.data()) < 0) return error();
        if (count == 0) return ok();
        const Handle memory = space(part), place(H5Dget_space(array.set), H5Sclose);
        const bool written = H5Sselect_hyperslab(place, H5S_SELECT_SET, from.data(), nullptr, part.data(), nullptr) >= 0 &&
                             H5Dwrite(array.set, typeOf(variable.type), memory, place, H5P_DEFAULT, values) >= 0;
        return written ? ok() : error();
    }

    Status close(size_t frames, const std::map<std::string, size_t>& lengths, std::span<const DataAttribute> attributes) {
        bool whole = true;
        for (const DataAttribute& a : attributes) whole = whole && addAttribute(file_, a);
        std::map<std::string, Handle> scales;
        if (const auto time = arrays_.find("time"); time != arrays_.end()) whole = whole && H5DSset_scale(time->second.set, "time") >= 0;
        for (auto& entry : arrays_) {
            Array& array = entry.second;  // clang 14: a lambda captures no structured binding
            array.size[0] = frames;
            if (!array.variable.items.empty()) array.size[1] = lengths.at(array.variable.items);
            whole = whole && H5Dset_extent(array.set, array.size.data()) >= 0;
            if (entry.first == "time") continue;
            unsigned k = 0;
            whole = whole && H5DSattach_scale(array.set, arrays_.at("time").set, k++) >= 0;
            const auto attach = [&](const DataAxis& axis) {
                Handle& scale = scales[axis.name];
                if (scale < 0) scale = addScale(axis);
                whole = whole && H5DSattach_scale(array.set, scale, k++) >= 0;
            };
            if (!array.variable.items.empty()) attach({array.variable.items, lengths.at(array.variable.items)});
            for (const DataAxis& axis : array.variable.axes) attach(axis);
        }
        for (auto& [name, scale] : scales) whole = scale.close() && whole;
        for (auto& [name, array] : arrays_) whole = array.set.close() && whole;
        whole = whole && H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0;
        if (!whole) return error();
        if (!file_.close()) return error();
        return to_.commit();
    }

  private:
    struct Array {
        DataVariable variable = {};
        Handle set = {};
        std::vector<hsize_t> size = {};
    };

    Status error() const { return failed(fmt::format("{} cannot be written: {}", path_, reason())); }

    bool create(const DataVariable& variable, Array& array) {
        array.variable = variable;
        array.size = {1};
        std::vector<hsize_t> most = {H5S_UNLIMITED}, chunk = {variable.items.empty() ? kValuesPerChunk : 1};
        if (!variable.items.empty()) {
            array.size.push_back(1);
            most.push_back(H5S_UNLIMITED);
            chunk.push_back(chunk_);
        }
        for (const DataAxis& axis : variable.axes) {
            array.size.push_back(axis.length);
            most.push_back(axis.length);
            chunk.push_back(axis.length);
        }
        const float nan = std::nanf("");
        const bool filled = !variable.items.empty(), whole = variable.type == DataType::whole32;
        const Handle extent = space(array.size, most.data()), making(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
        bool set = H5Pset_chunk(making, static_cast<int>(chunk.size()), chunk.data()) >= 0 && H5Pset_shuffle(making) >= 0 &&
                   H5Pset_deflate(making, kDeflateLevel) >= 0;
        const void* fill = whole ? static_cast<const void*>(&kNoId) : &nan;
        if (filled) set = set && H5Pset_fill_value(making, whole ? H5T_NATIVE_UINT32 : H5T_NATIVE_FLOAT, fill) >= 0;
        array.set =
            Handle(H5Dcreate2(file_, variable.name.c_str(), typeOf(variable.type), extent, H5P_DEFAULT, making, H5P_DEFAULT), H5Dclose);
        set = set && array.set >= 0 && addText(array.set, "units", variable.units) && addText(array.set, "long_name", variable.longName);
        for (const DataAttribute& a : variable.more) set = set && addAttribute(array.set, a);
        if (!filled) return set;
        const Handle one = space(std::array<hsize_t, 1>{1}),
                     attribute(H5Acreate2(array.set, "_FillValue", typeOf(variable.type), one, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
        return set && H5Awrite(attribute, typeOf(variable.type), fill) >= 0;
    }

    // An axis as a data set of its own: its labels, or none but its length.
    Handle addScale(const DataAxis& axis) const {
        const std::array<hsize_t, 1> length = {axis.length};
        const Handle extent = space(length);
        if (axis.labels.empty()) {
            Handle scale(H5Dcreate2(file_, axis.name.c_str(), H5T_IEEE_F32BE, extent, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
            // The text by which netCDF tells an axis without values.
            H5DSset_scale(scale, fmt::format("This is a netCDF dimension but not a netCDF variable.{:10}", axis.length).c_str());
            return scale;
        }
        const Handle type = textType();
        Handle scale(H5Dcreate2(file_, axis.name.c_str(), type, extent, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
        std::vector<std::string> letters;
        letters.reserve(axis.labels.size());
        for (const char letter : axis.labels) letters.emplace_back(1, letter);
        std::vector<const char*> texts;
        texts.reserve(letters.size());
        for (const std::string& letter : letters) texts.push_back(letter.c_str());
        H5Dwrite(scale, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data());
        H5DSset_scale(scale, axis.name.c_str());
        return scale;
    }

    NewFile to_;  // is destroyed after the library's handles
    std::string path_;
    size_t chunk_;
    Handle file_;
    std::map<std::string, Array> arrays_;
};

}  // namespace

Result<DataFile> createHdf5(const std::string& path, size_t chunk) {
    H5dont_atexit();  // a file that could not be closed is not tried again when the program ends
    Result<NewFile> to = NewFile::open(path);
    if (!to) return to.error();
    auto file = std::make_shared<Hdf5>(std::move(*to), path, chunk);
    if (Status begun = file->begin(); !begun) return begun.error();
    return DataFile{
        [file](const DataVariable& v, size_t frame, size_t count, const void* values) { return file->put(v, frame, count, values); },
        [file](size_t frames, const std::map<std::string, size_t>& lengths, std::span<const DataAttribute> attributes) {
            return file->close(frames, lengths, attributes);
        }};
}

}  // namespace rivulet

#endif
