// Exported particles, as readers that are not ours find them: tests/unit/read_particles.py by its own lights, VTK, assimp.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include "engine/core/file.h"
#include "engine/scene/import_model.h"
#include "fluid/io/export.h"
#include "fluid/io/mesh_file.h"
#include "fluid/render/backend.h"
#include "fluid/session/run_stats.h"
#include "fluid/session/session.h"
#include "tests/unit/program_runner.h"

namespace rivulet::testing::export_particles_test {
namespace {

// A block of water beside one of an oil, some metres or some thousand kilometres away.
std::string sceneAt(const std::string& origin) {
    return R"({"name": "two", "fluid": {"spacing": 0.02, "origin": )" + origin +
           R"(, "box": {"min": [0, 0, 0], "max": [0.4, 0.4, 0.3]}, "blocks": [{"min": [0.06, 0.0, 0.06], "max": [0.22, 0.16, 0.18]},
           {"min": [0.26, 0.04, 0.06], "max": [0.34, 0.2, 0.18], "velocity": [0.3, 0, 0.1], "liquid": "oil"}]}})";
}

struct Row {
    dvec3 position, velocity;
    double density = 0, mass = 0, pressure = 0;
};
struct Found {
    double time = 0;
    std::string type;
    std::map<uint32_t, Row> rows;
};

Outcome readerOn(const std::string& path, bool vtk) {
    std::vector<std::string> words = {"/usr/bin/python3", RIVULET_SOURCE_DIR "/tests/unit/read_particles.py"};
    if (vtk) words.emplace_back("--vtk");
    words.push_back(path);
    return runCommand(words);
}

Found foundBy(const Outcome& reader) {
    Found found;
    EXPECT_EQ(reader.code, 0) << reader.err;
    std::istringstream in(reader.out);
    std::string word;
    const auto number = [&] {  // nan and inf too, which a stream does not read
        in >> word;
        return std::strtod(word.c_str(), nullptr);
    };
    found.time = number();
    in >> found.type;
    for (uint32_t id = 0; in >> id;) {
        Row r;
        for (dvec3* v : {&r.position, &r.velocity})
            for (int k = 0; k < 3; ++k) (*v)[k] = number();
        r.density = number();
        r.mass = number();
        r.pressure = number();
        EXPECT_TRUE(found.rows.emplace(id, r).second) << id << " is there twice";
    }
    return found;
}

// The same scene stepped here, frame by frame: on the cpu a run is the same bit for bit.
struct Reference {
    std::unique_ptr<Device> device = makeCpu();
    std::unique_ptr<Session> session;
    HostParticles host;
    double time = 0;

    Reference(const std::string& scene, int frames) {
        Result<SceneFile> file = loadScene(scene, {});
        EXPECT_TRUE(file) << file.error().message;
        auto made = Session::create(*file, *device, {});
        EXPECT_TRUE(made) << made.error().message;
        session = std::move(*made);
        for (int f = 0; f < frames; ++f) session->step(frameSeconds(session->scene()), true);
        host = readParticles(session->world(), true);
        time = session->world().time();
    }
};

void expectSame(const Found& found, const Reference& reference, bool up) {
    const dvec3 origin = reference.session->world().origin();
    ASSERT_EQ(found.rows.size(), reference.host.id.size());
    ASSERT_GT(found.rows.size(), 500U);
    double mass = 0, expected = 0;
    for (size_t i = 0; i < reference.host.id.size(); ++i) {
        const auto at = found.rows.find(reference.host.id[i]);
        ASSERT_NE(at, found.rows.end());
        const Row& row = at->second;
        dvec3 place = origin + dvec3(vec3(reference.host.position[i])), velocity(vec3(reference.host.velocity[i]));
        // Upright by hand: what pointed along y points along z, and the sense of rotation stays.
        if (up) place = dvec3(place.x, -place.z, place.y);
        if (up) velocity = dvec3(velocity.x, -velocity.z, velocity.y);
        if (origin == dvec3(0.0))
            EXPECT_EQ(vec3(row.position), vec3(place));  // text is the shortest that reads back as that float
        else
            EXPECT_EQ(row.position, place);
        EXPECT_EQ(vec3(row.velocity), vec3(velocity));
        EXPECT_EQ(static_cast<float>(row.mass), reference.host.mass[i]);
        EXPECT_EQ(static_cast<float>(row.pressure), reference.host.pressure[i]);
        const double volume = std::pow(0.02, 3);
        EXPECT_NEAR(row.density, static_cast<double>(reference.host.position[i].w) * row.mass / volume, 1e-6 * row.density);
        mass += row.mass;
        expected += static_cast<double>(reference.host.mass[i]);
    }
    EXPECT_NEAR(mass, expected, 1e-7 * expected);
}

TEST(ExportParticles, AreTheSimulatedOnes) {
    for (const char* origin : {"[0, 0, 0]", "[3000000, -20, 7]"})
        for (const char* up : {"y", "z"}) {
            const Scratch scratch;
            const std::string scene = scratch.file("s.json", sceneAt(origin));
            const Reference reference(scene, 4);
            const bool far = reference.session->world().origin() != dvec3(0.0);
            for (const char* format : {"ply", "vtk", "csv"}) {
                RunOptions in;
                in.folder = scratch.path();
                const Outcome outcome = runProgram({"export", "s.json", "--format", format, "--every", "3", "--seconds", "0.1", "--up", up,
                                                    "--out", format, "--backend", "cpu"},
                                                   in);
                ASSERT_EQ(outcome.code, 0) << outcome.err;
                const std::string ending = format == std::string("vtk") ? "vtp" : format;
                const std::string path = (scratch.path() / format / ("two_particles_0003." + ending)).string();
                const Found found = foundBy(readerOn(path, false));
                expectSame(found, reference, up == std::string("z"));
                if (ending != "csv") {
                    EXPECT_DOUBLE_EQ(found.time, reference.time);
                    EXPECT_TRUE(found.type == (ending == "ply" ? (far ? "double" : "float") : (far ? "Float64" : "Float32"))) << found.type;
                }
            }
        }
}

TEST(ExportParticles, VtkReadsThem) {
    const Scratch scratch;
    const std::string scene = scratch.file("s.json", sceneAt("[100000, 0, 0]"));
    const Reference reference(scene, 4);
    RunOptions in;
    in.folder = scratch.path();
    const Outcome outcome =
        runProgram({"export", "s.json", "--format", "vtk", "--every", "3", "--seconds", "0.1", "--out", "vtk", "--backend", "cpu"}, in);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Outcome reader = readerOn((scratch.path() / "vtk/two_particles_0003.vtp").string(), true);
    if (reader.code == 77) GTEST_SKIP() << "python3-vtk9 is not installed: the section hosts of third_party/packages.txt";
    const Found found = foundBy(reader);
    EXPECT_EQ(found.type, "double");
    EXPECT_DOUBLE_EQ(found.time, reference.time);
    expectSame(found, reference, false);
}

// Of nothing, of one, of numbers that are none, and of bytes that are not three by three.
TEST(ExportParticles, OddOnesAreWrittenToo) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (size_t count : {0U, 1U, 2U, 3U, 4U}) {
        std::vector<vec4> position, velocity;
        std::vector<uint32_t> id;
        std::vector<float> mass, pressure;
        for (uint32_t i = 0; i < count; ++i) {
            position.emplace_back(0.1F * static_cast<float>(i), i == 1 ? nan : 2.0F, i == 2 ? -inf : 3.0F, 0.5F);
            velocity.emplace_back(1e-42F, -1.0F, 1e30F, 0.0F);
            id.push_back(0xFFFFFFFFU - i);
            mass.push_back(0.25F);
            pressure.push_back(-7.0F);
        }
        const ExportParticles of{position, velocity, id, mass, pressure, 0.001, 1.0 / 3};
        for (const ParticleFormat& format : particleFormats().rows) {
            const Scratch scratch;
            const std::string path = scratch.file(fmt::format("p.{}", format.ending), format.write(of, {}));
            const Found found = foundBy(readerOn(path, false));
            ASSERT_EQ(found.rows.size(), count) << format.name;
            if (format.name != std::string("csv")) EXPECT_EQ(found.time, 1.0 / 3);
            for (uint32_t i = 0; i < count; ++i) {
                const Row& row = found.rows.at(id[i]);
                EXPECT_EQ(static_cast<float>(row.position.x), position[i].x);
                EXPECT_EQ(std::isnan(row.position.y), i == 1);
                EXPECT_EQ(std::isinf(row.position.z), i == 2);
                EXPECT_EQ(vec3(row.velocity), vec3(velocity[i]));
                EXPECT_FLOAT_EQ(static_cast<float>(row.density), 125.0F);
            }
        }
    }
}

// Assimp takes a first byte that is a line's end for the head's: no first byte is one, and nothing is rounded for it.
TEST(ExportParticles, NoPlyBeginsWithALineFeed) {
    const std::vector<vec4> position = {vec4(std::bit_cast<float>(0x3D76F70AU), 0, 0, 1), vec4(std::bit_cast<float>(0x3D76F70DU), 0, 0, 1),
                                        vec4(0.5F, 0, 0, 1)};
    const std::vector<vec4> velocity(3, vec4(0.0F));
    const std::vector<uint32_t> id = {0, 1, 2};
    const std::vector<float> mass(3, 1.0F);
    const std::string bytes = writeParticlesPly({position, velocity, id, mass, {}, 1, 0});
    const std::string_view end = "end_header\n";
    const char first = bytes[bytes.find(end) + end.size()];
    EXPECT_TRUE(first != '\n' && first != '\r');
    EXPECT_EQ(bytes.size() - bytes.find(end) - end.size(), 3 * 36U);
}

// A surface exported with +Z up keeps its normals outward and its position.
TEST(ExportParticles, SurfacesTurnUprightToo) {
    const std::vector<vec3> corners = {vec3(0), vec3(1, 0, 0), vec3(0, 2, 0), vec3(0, 0, 3)};
    const std::vector<uint32_t> sides = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    const std::vector<vec3> normals(4, vec3(0, 1, 0));
    for (const MeshFormat& format : meshFormats().rows) {
        const Scratch scratch;
        const std::string path = scratch.file(std::string("t.") + format.name);
        ASSERT_TRUE(writeFileAtomic(path, format.write({corners, sides, normals, {}}, {UpAxis::z, dvec3(0, 0, 0)})));
        const Result<Mesh> mesh = importMesh(path);
        ASSERT_TRUE(mesh) << mesh.error().message;
        EXPECT_EQ(mesh->bounds().min, vec3(0, -3, 0));
        EXPECT_EQ(mesh->bounds().max, vec3(1, 0, 2)) << "what was up, y, is up, z";
        for (const vec3& n : mesh->normals) EXPECT_EQ(n, vec3(0, 0, 1));
        double six = 0;  // times the volume: positive while triangles are seen from outside as they were
        for (size_t k = 0; k < mesh->indices.size(); k += 3)
            six += static_cast<double>(glm::dot(mesh->positions[mesh->indices[k]],
                                                glm::cross(mesh->positions[mesh->indices[k + 1]], mesh->positions[mesh->indices[k + 2]])));
        EXPECT_NEAR(six, 6, 1e-5);
    }
    const std::string far = writeObj({corners, sides, {}, {}}, {UpAxis::y, dvec3(3000000, 0, 0.001)});
    EXPECT_NE(far.find("v 3000001 0 0.001\n"), std::string::npos) << far;
}

TEST(ExportParticles, TheCollectionGivesEachFileItsTime) {
    const Scratch scratch;
    scratch.file("s.json", smallScene());
    RunOptions in;
    in.folder = scratch.path();
    const Outcome outcome = runProgram({"export", "s.json", "--format", "vtk", "--surface", "ply", "--every", "2", "--seconds", "0.0667",
                                        "--out", "o", "--backend", "cpu", "--set", "timeScale=0.5"},
                                       in);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const std::string list = readFile((scratch.path() / "o/small_particles.pvd").string()).value();
    size_t seen = 0;
    for (int f = 0; f < 8; f += 2) {
        const std::string file = fmt::format("small_particles_{:04}.vtp", f), entry = fmt::format("part=\"0\" file=\"{}\"", file);
        EXPECT_NE(list.find(entry), std::string::npos) << list;
        const size_t at = list.rfind("timestep=\"", list.find(entry));
        EXPECT_NEAR(std::strtod(list.c_str() + at + 10, nullptr), (f + 1) / 120.0, 1e-9);
        const Found found = foundBy(readerOn((scratch.path() / "o" / file).string(), false));
        EXPECT_NEAR(found.time, (f + 1) / 120.0, 1e-9);
        seen += std::filesystem::exists(scratch.path() / fmt::format("o/small_{:04}.ply", f)) ? 1 : 0;
    }
    EXPECT_EQ(seen, 4U);
}

TEST(ExportParticles, ErrorsNameTheirCause) {
    const Scratch scratch;
    scratch.file("s.json", smallScene());
    scratch.file("file", "not a folder");
    RunOptions in;
    in.folder = scratch.path();
    expectRefusal(runProgram({"export", "s.json", "--format", "vtp"}, in), 2, "did you mean 'vtk'");
    expectRefusal(runProgram({"export", "s.json", "--format", "alembic"}, in), 2, "use one of: ply, vtk, csv");
    expectRefusal(runProgram({"export", "s.json", "--format", "csv", "--up", "x"}, in), 2, "unknown axis 'x'");
    expectRefusal(runProgram({"export", "s.json", "--format", "csv", "--every", "0"}, in), 2, "--every");
    expectRefusal(runProgram({"export", "s.json", "--format", "csv", "--out", "file/here"}, in), 1, "file/here");
    const Outcome full = runProgram({"export", "s.json", "--format", "csv", "--seconds", "0.05", "--out", "/dev/full"}, in);
    EXPECT_EQ(full.code, 1) << full.err;
}

}  // namespace
}  // namespace rivulet::testing::export_particles_test
