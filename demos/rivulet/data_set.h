// Particles of all frames in one file or folder: HDF5 and Zarr, for xarray, h5py and zarr-python.
//
// Arrays have the axes (time, particle, component), as xarray users expect. Frames differ in their number of particles: the axis is as long
// as the largest frame, and shorter ones are filled with NaN; count(time) has the numbers. Within a frame particles are in the order of
// their ids: where none leaves, an index is the same particle in all frames. A ragged array (CF conventions, 9.3.3) would have no such
// index, and padding costs next to nothing once it is compressed. Names, units and attributes follow the CF conventions.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/core/result.h"
#include "engine/core/table.h"
#include "fluid/io/recording.h"
#include "fluid/scene/scene_file.h"

namespace rivulet {

// A value by its name; `json` is a number, three numbers in brackets, true, false, or a string in quotes.
struct DataAttribute {
    std::string name, json;
};

enum class DataType { real32, real64, whole32 };  // whole32: unsigned
size_t bytesOf(DataType type);
inline constexpr uint32_t kNoId = 0xFFFFFFFF;  // fills whole32

// An axis of a fixed length; its labels, if it has any, are a letter each.
struct DataAxis {
    std::string name;
    size_t length = 1;
    std::string labels = {};
};

struct DataVariable {
    std::string name;
    DataType type = DataType::real32;
    std::string items;           // name of the second axis; "": one value a frame
    std::vector<DataAxis> axes;  // after these
    std::string units, longName;
    std::vector<DataAttribute> more = {};
    size_t itemBytes() const;  // of all axes of one item
};

// A file that is being written. It gets its name in close(); destroyed before, it leaves nothing. Errors (failed): disk full, not writable.
struct DataFile {
    // Adds the rows of a frame, in the order of the frames. A variable may begin in any frame and be left out in any: it is filled there.
    std::function<Status(const DataVariable& variable, size_t frame, size_t count, const void* values)> put;
    // Ends the file: the number of frames, the length of each axis `items`, the attributes of the whole.
    std::function<Status(size_t frames, const std::map<std::string, size_t>& lengths, std::span<const DataAttribute> attributes)> close;
};

struct DataSetFormat {
    const char* name;
    const char* doc;
    const char* ending;
    bool replaces;  // a file that exists
    // `chunk`: items in a chunk; a chunk never has more than one frame. Null: this build lacks the format's library.
    Result<DataFile> (*create)(const std::string& path, size_t chunk);
    const char* missing;  // remedy if create is null
};
const Table<DataSetFormat>& dataSetFormats();
Result<DataFile> createHdf5(const std::string& path, size_t chunk);
Result<DataFile> createZarr(const std::string& path, size_t chunk);

// Every parameter of the scene by its path in docs/parameters.md.
std::vector<DataAttribute> parametersOf(SceneFile scene);
std::string jsonText(const std::string& text);  // in quotes

// Writes a data set frame by frame; holds one frame.
class DataSetWriter {
  public:
    // Error (failed): a folder or file of this name exists and is not replaced; not writable; the format's library is missing.
    static Result<DataSetWriter> open(const DataSetFormat& format, const std::string& path);
    // Before the first frame: particles of the largest frame, so that a chunk holds a frame. Without it all are taken to be as the first.
    void expect(size_t particles) { expected_ = particles; }
    Status add(RecordedFrame frame);
    Status close(std::vector<DataAttribute> attributes);
    size_t frames() const { return times_.size(); }
    size_t particles() const { return particles_; }  // of all frames

  private:
    DataSetWriter(const DataSetFormat& format, std::string path) : format_(&format), path_(std::move(path)) {}
    Status put(const DataVariable& variable, size_t count, const void* values);

    const DataSetFormat* format_;
    std::string path_;
    std::unique_ptr<DataFile> file_;  // null: before the first frame
    std::vector<double> times_;
    std::map<std::string, size_t> lengths_;
    size_t particles_ = 0, expected_ = 0;
};

}  // namespace rivulet
