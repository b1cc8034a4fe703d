// A recorded run as a file (.rrec): what each frame draws, to be shown again without simulating, from any frame.
//
// Numbers are those that were drawn, bit for bit; a frame with one that is not finite, or beyond 1e15, is not read. The file, in the byte
// order of the machine that wrote it: a header with a text, then for each frame 48 bytes of head and one zstd frame (packed_array.h) of its
// arrays, each sorted into planes of bytes; at the end an index. A run that was killed leaves no index: the reader rebuilds it frame by
// frame and leaves out a frame that was cut off. XXH3 checks the header with the text, each head, each frame's bytes, the index.
//
// An older recording of the name stays until the new one is complete. If there is none, the file has its name from its first frame on, so
// that the frames of a killed run can be shown.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/descriptor.h"
#include "engine/core/math.h"
#include "engine/core/new_file.h"
#include "engine/core/result.h"
#include "fluid/sim/world/fluid_params.h"
#include "shaders/fluid/sources/dry_volume.h"

namespace rivulet {

struct RecordedFrame {
    double time = 0;                              // s, simulated
    float spacing = 0;                            // m, of the particles
    bool halves = false;                          // whether particles of even id may be drawn first, as FluidView::half
    Bounds box;                                   // m, the world's box
    std::vector<vec4> position, velocity;         // as ParticleView::drawn and velocity, without free slots; in the order that was drawn
    std::vector<uint32_t> id;                     // constant for a particle from frame to frame
    std::vector<vec4> normal, absorption;         // as ParticleView; empty: none
    std::array<std::vector<vec4>, 3> ellipsoids;  // as ParticleView; empty: none
    // As ParticleView; empty: none. A file does not hold them: of a frame that was read they are empty.
    std::array<std::vector<vec4>, kMostAttributes> attributes;
    std::vector<vec4> foam, foamVelocity;  // as ParticleView::foamDrawn and foamVelocity
    std::vector<mat4> places;              // of solids that move, own frame -> world
    std::vector<vec3> corners;             // m, of solids that bend, one after the other
    std::vector<DryVolume> dry;            // as FluidWorld::dry
};

// The run that a recording's text names: any lines of the program that writes it, then these.
struct RecordedRun {
    std::string version;  // of the program that recorded; all are "" if its text names no run
    std::string device;   // "cpu: NAME"
    std::string scene;    // as JSON: what differs from the defaults, at the time when the recording began
};
std::string textOf(const RecordedRun& run);  // to be added to a text
RecordedRun recordedRun(const std::string& text);
size_t endOfAbout(std::string_view text);  // where the part begins that only names the run

class RecordingWriter {
  public:
    // Begins the file. `about`: a text that the reader returns unchanged. Error (failed): not writable.
    static Result<RecordingWriter> open(const std::string& path, const std::string& about);
    // Writes a frame before it returns. Error (failed): disk full, out of memory; without an older file, frames added before stay valid.
    Status add(const RecordedFrame& frame);
    // Writes the index and replaces an older file. Error as add.
    Status close();

    size_t frames() const { return offsets_.size(); }
    uint64_t bytes() const { return at_; }

  private:
    RecordingWriter(NewFile file, std::string path) : file_(std::move(file)), path_(std::move(path)) {}
    Status put(const std::string& bytes, const std::string& what);

    NewFile file_;
    std::string path_;
    uint64_t at_ = 0;
    std::vector<uint64_t> offsets_;
};

// Whether a file begins as a recording does, or is named so: FILE.rrec.
bool isRecording(const std::string& path);

class RecordingReader {
  public:
    // For any bytes: error (badInput): a fault of the file, and where; (failed): it cannot be read, out of memory.
    static Result<RecordingReader> open(const std::string& path);

    const std::string& about() const { return about_; }
    size_t frames() const { return offsets_.size(); }  // at least 1
    // Particles of the largest frame, by the frames' first bytes: an estimate, because no checksum is compared.
    size_t largest() const;
    // A sentence if the file has no end, because the run was killed or a copy was cut off; else "".
    const std::string& cut() const { return cut_; }
    // Frame k < frames(). A frame of more than `memoryLimit` bytes is refused. Error: as open.
    Result<RecordedFrame> read(size_t k, size_t memoryLimit = size_t{16} << 30U);

  private:
    RecordingReader(Descriptor file, std::string path) : file_(std::move(file)), path_(std::move(path)) {}
    Error damaged(const std::string& what) const;
    Status readHeader();
    bool readIndex();
    Status scan();
    bool take(uint64_t at, void* to, size_t bytes) const;

    Descriptor file_;
    std::string path_, about_, cut_;
    uint64_t size_ = 0, first_ = 0;  // bytes: of the file; where the first frame is
    std::vector<uint64_t> offsets_;
};

}  // namespace rivulet
