// Zarr, version 2: a folder for each array, with JSON and a file for each chunk. https://zarr.readthedocs.io/en/stable/spec/v2.html
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <set>
#include <system_error>

#include "demos/rivulet/data_set.h"
#include "engine/core/file.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

constexpr int kZstdLevel = 3;             // of zstd
constexpr size_t kFramesPerChunk = 4096;  // of a variable with one value a frame

std::string typeText(DataType type) {
    return fmt::format("{}{}{}", std::endian::native == std::endian::little ? '<' : '>', type == DataType::whole32 ? 'u' : 'f',
                       bytesOf(type));
}

// Bytes 0 of all values, then bytes 1, ...: numcodecs' filter "shuffle".
std::string shuffled(const std::string& bytes, size_t size) {
    std::string out(bytes.size(), '\0');
    const size_t n = bytes.size() / size;
    for (size_t b = 0; b < size; ++b)
        for (size_t i = 0; i < n; ++i) out[b * n + i] = bytes[i * size + b];
    return out;
}

// The hidden name that a folder has until it is complete: start, process and end. The start has the machine's name, because machines that
// share a disk do not share numbers of processes.
struct HiddenName {
    explicit HiddenName(const std::string& path) : folder(fs::absolute(fs::path(path)).parent_path()) {
        std::array<char, 65> host = {};
        (void)::gethostname(host.data(), host.size() - 1);
        start = fmt::format(".rivulet-{}-", host.data());
        constexpr size_t kEnd = 100;  // bytes: the whole must not be too long for a name
        std::string name = fs::path(path).filename().string();
        if (name.size() > kEnd) name.erase(0, name.size() - kEnd);
        end = "-" + name;
    }

    std::string ofThisProcess() const { return (folder / fmt::format("{}{}{}", start, ::getpid(), end)).string(); }

    // Removes folders of processes of this machine that were killed.
    void removeLeft() const {
        std::error_code error;
        for (fs::directory_iterator at(folder, error), last; !error && at != last; at.increment(error)) {
            const std::string name = at->path().filename().string();
            if (name.size() <= start.size() + end.size() || !name.starts_with(start) || !name.ends_with(end)) continue;
            const char* const number = name.data() + start.size();
            const char* const after = name.data() + name.size() - end.size();
            pid_t process = 0;
            const auto [read, wrong] = std::from_chars(number, after, process);
            if (wrong != std::errc() || read != after || process <= 0) continue;
            std::error_code ignored;
            if (process == ::getpid() || (::kill(process, 0) != 0 && errno == ESRCH)) fs::remove_all(at->path(), ignored);
        }
    }

    fs::path folder;
    std::string start, end;
};

class Zarr {
  public:
    Zarr(std::string path, size_t chunk) : path_(std::move(path)), hidden_(path_), part_(hidden_.ofThisProcess()), chunk_(chunk) {}
    Zarr(const Zarr&) = delete;
    Zarr& operator=(const Zarr&) = delete;
    ~Zarr() {
        std::error_code error;
        fs::remove_all(part_, error);
    }

    Status begin() const {
        hidden_.removeLeft();
        std::error_code error;
        fs::create_directory(part_, error);
        return error ? Status(failed(fmt::format("{} cannot be written: {}", path_, error.message()))) : ok();
    }

    Status put(const DataVariable& variable, size_t frame, size_t count, const void* values) {
        const auto [at, added] = arrays_.try_emplace(variable.name, Array{variable, {}});
        if (added)
            if (Status made = addFolder(part_ + "/" + variable.name); !made) return made;
        if (variable.items.empty()) return putValue(at->second, frame, values);
        const size_t bytes = variable.itemBytes();
        for (size_t first = 0; first < count; first += chunk_) {
            const size_t here = std::min(chunk_, count - first);
            std::string raw(static_cast<const char*>(values) + first * bytes, here * bytes);
            std::string name = fmt::format("{}.{}", frame, first / chunk_);
            for (size_t k = 0; k < variable.axes.size(); ++k) name += ".0";
            if (Status written = putChunk(variable, name, std::move(raw), chunk_ * bytes); !written) return written;
        }
        return ok();
    }

    Status close(size_t frames, const std::map<std::string, size_t>& lengths, std::span<const DataAttribute> attributes) {
        for (auto& [name, array] : arrays_)
            if (array.variable.items.empty()) {
                array.values.resize(frames * bytesOf(array.variable.type), '\0');
                for (size_t first = 0; first < frames; first += kFramesPerChunk) {
                    const size_t bytes = bytesOf(array.variable.type);
                    std::string raw = array.values.substr(first * bytes, kFramesPerChunk * bytes);
                    const std::string chunk = fmt::format("{}", first / kFramesPerChunk);
                    if (Status put = putChunk(array.variable, chunk, std::move(raw), kFramesPerChunk * bytes); !put) return put;
                }
            }
        if (Status written = putJson(".zgroup", R"({"zarr_format": 2})"); !written) return written;
        if (Status written = putJson(".zattrs", objectOf(attributes)); !written) return written;
        std::map<std::string, DataAxis> labelled;
        for (const auto& [name, array] : arrays_) {
            if (Status described = describe(array.variable, frames, lengths); !described) return described;
            for (const DataAxis& axis : array.variable.axes)
                if (!axis.labels.empty()) labelled[axis.name] = axis;
        }
        for (const auto& [name, axis] : labelled)
            if (Status added = addLabels(axis); !added) return added;
        std::string all = R"({"zarr_consolidated_format": 1, "metadata": {)";
        for (const auto& [name, text] : json_) all += fmt::format("{}\"{}\": {}", all.ends_with('{') ? "" : ", ", name, text);
        if (Status written = writeFileAtomic(part_ + "/.zmetadata", all + "}}\n"); !written) return written;
        std::error_code error;
        fs::rename(part_, path_, error);  // refuses a folder that is not empty
        return error ? Status(failed(fmt::format("{} cannot be written: {}", path_, error.message()))) : ok();
    }

  private:
    struct Array {
        DataVariable variable;
        std::string values;  // of a variable with one value a frame
    };

    static Status putValue(Array& array, size_t frame, const void* value) {
        const size_t bytes = bytesOf(array.variable.type);
        array.values.resize(frame * bytes, '\0');
        array.values.append(static_cast<const char*>(value), bytes);
        return ok();
    }

    static Status addFolder(const std::string& path) {
        std::error_code error;
        fs::create_directory(path, error);
        return error ? Status(failed(fmt::format("{} cannot be made: {}", path, error.message()))) : ok();
    }

    // A chunk is always whole: what is missing is filled.
    Status putChunk(const DataVariable& variable, const std::string& name, std::string raw, size_t whole) {
        const size_t size = bytesOf(variable.type), old = raw.size();
        raw.resize(whole);
        for (size_t at = old; at < whole; at += size) {
            const float nan = std::nanf("");
            if (variable.items.empty())
                std::memset(raw.data() + at, 0, size);
            else if (variable.type == DataType::whole32)
                std::memcpy(raw.data() + at, &kNoId, size);
            else
                std::memcpy(raw.data() + at, &nan, size);
        }
        raw = shuffled(raw, size);
        std::string packed(ZSTD_compressBound(raw.size()), '\0');
        const size_t bytes = ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), kZstdLevel);
        if (ZSTD_isError(bytes) != 0) return failed(fmt::format("{} cannot be compressed: {}", path_, ZSTD_getErrorName(bytes)));
        packed.resize(bytes);
        return save(variable.name + "/" + name, packed);
    }

    // The message names the data set, not the temporary folder.
    Status save(const std::string& name, std::string_view bytes) const {
        Status written = writeFileAtomic(part_ + "/" + name, bytes, 0666, Sync::none);
        if (written) return written;
        std::string message = written.error().message;
        if (const size_t at = message.find(part_); at != std::string::npos) message.replace(at, part_.size(), path_);
        return failed(message);
    }

    Status putJson(const std::string& name, const std::string& text) {
        json_[name] = text;
        return save(name, text + "\n");
    }

    static std::string objectOf(std::span<const DataAttribute> attributes) {
        std::string text = "{";
        for (const DataAttribute& a : attributes) text += fmt::format("{}{}: {}", text.size() > 1 ? ", " : "", jsonText(a.name), a.json);
        return text + "}";
    }

    Status describe(const DataVariable& variable, size_t frames, const std::map<std::string, size_t>& lengths) {
        const bool scalar = variable.items.empty();
        std::string shape = fmt::format("{}", frames), chunks = scalar ? fmt::format("{}", kFramesPerChunk) : "1", axes = "\"time\"";
        if (!scalar) {
            shape += fmt::format(", {}", lengths.at(variable.items));
            chunks += fmt::format(", {}", chunk_);
            axes += fmt::format(", \"{}\"", variable.items);
        }
        for (const DataAxis& axis : variable.axes) {
            shape += fmt::format(", {}", axis.length);
            chunks += fmt::format(", {}", axis.length);
            axes += fmt::format(", \"{}\"", axis.name);
        }
        const std::string fill = scalar ? "null" : variable.type == DataType::whole32 ? fmt::format("{}", kNoId) : "\"NaN\"";
        Status written =
            putJson(variable.name + "/.zarray",
                    fmt::format(R"({{"zarr_format": 2, "shape": [{}], "chunks": [{}], "dtype": "{}", "order": "C", "fill_value": {}, )"
                                R"("filters": [{{"id": "shuffle", "elementsize": {}}}], "compressor": {{"id": "zstd", "level": {}}}}})",
                                shape, chunks, typeText(variable.type), fill, bytesOf(variable.type), kZstdLevel));
        if (!written) return written;
        std::vector<DataAttribute> attributes = {
            {"_ARRAY_DIMENSIONS", "[" + axes + "]"}, {"units", jsonText(variable.units)}, {"long_name", jsonText(variable.longName)}};
        attributes.insert(attributes.end(), variable.more.begin(), variable.more.end());
        return putJson(variable.name + "/.zattrs", objectOf(attributes));
    }

    // A coordinate of letters, in UTF-32.
    Status addLabels(const DataAxis& axis) {
        if (Status made = addFolder(part_ + "/" + axis.name); !made) return made;
        std::string raw;
        for (const char letter : axis.labels) {
            const auto code = static_cast<uint32_t>(letter);
            raw.append(reinterpret_cast<const char*>(&code), sizeof(code));
        }
        if (Status written = save(axis.name + "/0", raw); !written) return written;
        if (Status written = putJson(axis.name + "/.zarray",
                                     fmt::format(R"({{"zarr_format": 2, "shape": [{0}], "chunks": [{0}], "dtype": "{1}U1", "order": "C", )"
                                                 R"("fill_value": null, "filters": null, "compressor": null}})",
                                                 axis.length, typeText(DataType::whole32)[0]));
            !written)
            return written;
        return putJson(axis.name + "/.zattrs", fmt::format(R"({{"_ARRAY_DIMENSIONS": ["{}"]}})", axis.name));
    }

    std::string path_;
    HiddenName hidden_;
    std::string part_;
    size_t chunk_;
    std::map<std::string, Array> arrays_;
    std::map<std::string, std::string> json_;  // by name
};

}  // namespace

Result<DataFile> createZarr(const std::string& path, size_t chunk) {
    auto zarr = std::make_shared<Zarr>(path, chunk);
    if (Status begun = zarr->begin(); !begun) return begun.error();
    return DataFile{
        [zarr](const DataVariable& v, size_t frame, size_t count, const void* values) { return zarr->put(v, frame, count, values); },
        [zarr](size_t frames, const std::map<std::string, size_t>& lengths, std::span<const DataAttribute> attributes) {
            return zarr->close(frames, lengths, attributes);
        }};
}

}  // namespace rivulet
