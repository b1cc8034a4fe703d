// Particles to files: PLY, VTK, CSV. From plain spans, so that a host can write particles that it has read back.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "engine/core/table.h"
#include "fluid/io/export_frame.h"

namespace rivulet {

// The particles at one time, all spans as long as `position`.
struct ExportParticles {
    std::span<const vec4> position;  // xyz m, w density / rest density, as ParticleView::position without its free slots
    std::span<const vec4> velocity;  // xyz m/s
    std::span<const uint32_t> id;    // constant for a particle from file to file; the order is not
    std::span<const float> mass;     // kg
    std::optional<std::span<const float>> pressure = {};  // Pa; nothing: not written
    double volume = 0;                                    // m^3, of a particle at rest density: spacing^3
    double time = 0;                                      // s, simulated
    double density(size_t i) const {                      // kg/m^3
        return volume > 0 ? static_cast<double>(position[i].w) * static_cast<double>(mass[i]) / volume : 0;
    }
};

struct ParticleFormat {
    const char* name;
    const char* doc;
    const char* ending;                                                         // of the file
    std::string (*write)(const ExportParticles& of, const ExportFrame& frame);  // the file's bytes
};
const Table<ParticleFormat>& particleFormats();

// Numbers read back exactly: floats; places are doubles if the frame has an origin.
std::string writeParticlesPly(const ExportParticles& of, const ExportFrame& frame = {});  // binary, little-endian; vertices without faces
std::string writeParticlesVtp(const ExportParticles& of, const ExportFrame& frame = {});  // VTK's XML PolyData, its numbers in base64
std::string writeParticlesCsv(const ExportParticles& of, const ExportFrame& frame = {});  // a header with units, then one line a particle

// A .pvd file: the time of each .vtp, so that ParaView plays them at the right speed.
struct TimedFile {
    double time = 0;   // s
    std::string file;  // relative to the .pvd; of plain letters
};
std::string writeVtkCollection(std::span<const TimedFile> files);

}  // namespace rivulet
