// make_head FACE.obj FOLDER: writes the head model of the project: FOLDER/head.glb, its textures and head.json. Output is reproducible.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "assets/make_head/cage.h"
#include "assets/make_head/glb.h"
#include "assets/make_head/hair.h"
#include "assets/make_head/morphs.h"
#include "assets/make_head/mouth.h"
#include "assets/make_head/paint.h"
#include "engine/core/file.h"

namespace rivulet::head {
namespace {

// Checks that must pass before a file is written.
Status checkChart(const Surface& head, const SkinPictures& skin) {
    for (const Vertex& v : head.vertices)
        if (v.uv.x < 0 || v.uv.x > 1 || v.uv.y < 0 || v.uv.y > 1)
            return failed(fmt::format("the head's chart leaves the tile at ({:.4f}, {:.4f})", v.uv.x, v.uv.y));
    size_t flipped = 0;
    dvec2 where(0);
    for (const Triangle& t : head.triangles)
        if (uvArea(head, t) <= 0) {
            ++flipped;
            where = head.vertices[t[0]].uv;
        }
    if (flipped > 0)
        return failed(fmt::format("{} triangles of the head's chart are flipped, one at ({:.4f}, {:.4f})", flipped, where.x, where.y));
    if (skin.overlaps > 0) return failed(fmt::format("the head's chart overlaps itself in {} texels", skin.overlaps));
    if (skin.cheekMillimetres > 0.35)
        return failed(
            fmt::format("a texel on the cheeks is {:.2f} mm wide, more than 0.35 mm: enlarge the face in the tile", skin.cheekMillimetres));
    return ok();
}

std::string text(dvec3 p) {
    p = rounded(p) / 100.0;
    return fmt::format("[{:.6f}, {:.6f}, {:.6f}]", p.x + 0.0, p.y + 0.0, p.z + 0.0);
}

struct OnSkin {
    dvec3 at{0};
    dvec2 uv{0};
};

OnSkin nearestOnSkin(const Surface& head, dvec3 p) {
    OnSkin best;
    double least = 1e9;
    for (const Triangle& t : head.triangles) {
        const Vertex *a = &head.vertices[t[0]], *b = &head.vertices[t[1]], *c = &head.vertices[t[2]];
        if (glm::distance(a->at, p) > 1.0) continue;
        constexpr int kSteps = 8;  // finer than 0.2 mm on triangles this small
        for (int i = 0; i <= kSteps; ++i)
            for (int j = 0; i + j <= kSteps; ++j) {
                double u = static_cast<double>(i) / kSteps, v = static_cast<double>(j) / kSteps, w = 1 - u - v;
                dvec3 at = a->at * w + b->at * u + c->at * v;
                if (double d = glm::distance(at, p); d < least) {
                    least = d;
                    best = {at, a->uv * w + b->uv * u + c->uv * v};
                }
            }
    }
    return best;
}

// Writes head.json: the positions that simulations need (eyes, lids, lips, ...).
std::string describe(const Surface& head, const std::array<Eye, 2>& eyes) {
    std::string sides;
    for (int k = 0; k < 2; ++k) {
        const Eye& eye = eyes[k];
        size_t n = eye.loop.size(), atCorner = n / 2 - n / 16;
        EyePoint below = eye.seen(head.vertices[eye.loop[atCorner]].at);
        below.up -= 0.25 / (kEyeRadius + below.height);
        OnSkin tear = nearestOnSkin(head, eye.placed(below));
        std::string margin;
        for (size_t i = n / 2 + 1; i-- > 0;)
            margin += fmt::format("{}{}", margin.empty() ? "" : ", ", text(head.vertices[eye.rings[3][i]].at));
        sides += fmt::format(
            "    \"{}\": {{\n      \"eyeball\": {{\"centre\": {}, \"radius\": {:.4f}}},\n      \"inner_corner\": {},\n      "
            "\"outer_corner\": {},\n"
            "      \"tear\": {{\"position\": {}, \"uv\": [{:.5f}, {:.5f}]}},\n      \"lower_lid_margin\": [{}]\n    }}{}\n",
            k == 0 ? "left" : "right", text(eye.centre), kEyeRadius / 100, text(head.vertices[eye.loop[n / 2]].at),
            text(head.vertices[eye.loop[0]].at), text(tear.at), tear.uv.x, tear.uv.y, margin, k == 0 ? "," : "");
    }
    return fmt::format(
        "{{\n  \"units\": \"m\",\n  \"axes\": \"+Y up, +Z forward, +X to the subject's left\",\n"
        "  \"uv\": \"v up, as in OBJ; the glb stores 1 - v\",\n"
        "  \"margins\": \"along the wet edge of the lower lid, from the inner corner to the outer\",\n"
        "  \"skin\": {{\n    \"albedo\": \"head_albedo.jpg\",\n    \"relief\": \"head_relief.png\",\n    \"relief_mm_per_step\": {},\n"
        "    \"relief_zero\": 128,\n    \"regions\": \"skin_regions.png\",\n"
        "    \"regions_channels\": [\"oily\", \"dry\", \"hair\", \"lip\"]\n  }},\n  \"eyes\": {{\n{}  }}\n}}\n",
        kMillimetresPerStep, sides);
}

// The model's nostrils are closed.
void hollowNostrils(Surface& head) {
    for (Vertex& v : head.vertices) {
        dvec3 d = (dvec3(std::abs(v.at.x), v.at.y, v.at.z) - dvec3(0.80, -1.25, 6.28)) / dvec3(0.27, 0.33, 0.42);
        double depth = std::exp(-0.5 * glm::dot(d, d));
        v.at.y += 0.42 * depth;
    }
}

Result<size_t> make(const std::string& facePath, const std::string& folder) {
    Result<Surface> cage = buildCage(facePath);
    if (!cage) return cage.error();
    Surface head = subdivided(subdivided(*cage));
    hollowNostrils(head);
    std::array<Eye, 2> eyes = fitLids(head);
    for (Vertex& v : head.vertices) v.at = rounded(v.at);
    if (head.vertices.size() > 65535) return failed(fmt::format("the head has {} vertices, more than 65535", head.vertices.size()));

    SkinPictures skin = paintSkin(head, eyes);
    if (Status sound = checkChart(head, skin); !sound) return sound.error();
    std::vector<Part> parts(1);
    parts[0] = {"skin", "skin", positionsOf(head), {}, {}, head.triangles, makeMorphs(head, eyes)};
    parts[0].normals = normalsOf(parts[0].positions, head.triangles);
    for (const Vertex& v : head.vertices) parts[0].uvs.push_back(v.uv);
    for (const Eye& eye : eyes) {
        std::vector<Lash> ofVertex;
        Part lashes = makeLashes(eye, head, ofVertex);
        lashes.morphs = lashMorphs(lashes, ofVertex, head, eye, parts[0].morphs, clumped(lashes, ofVertex));
        std::vector<dvec3> full;
        std::vector<Lash> ofDrop;
        Part drops = makeLashDrops(eye, lashes, ofVertex, full, ofDrop);
        drops.morphs = lashMorphs(drops, ofDrop, head, eye, parts[0].morphs, full);
        Part ball = makeEyeball(eye);
        ball.morphs = eyeMorphs(ball, eye);
        for (Part& part : std::vector<Part>{ball, makeCaruncle(eye), lashes, drops}) parts.push_back(part);
    }
    std::vector<double> jaw;
    Part teeth = makeTeeth(jaw);
    teeth.morphs = jawMorphs(teeth, jaw);
    Part tongue = makeTongue(jaw);
    tongue.morphs = jawMorphs(tongue, jaw);
    std::vector<uint32_t> roots;
    Part brows = makeBrows(head, roots);
    brows.morphs = carriedMorphs(roots, parts[0].morphs);
    for (Part& part : std::vector<Part>{teeth, tongue, brows, makeHair(head)}) parts.push_back(part);
    for (const Eye& eye : eyes) {  // last, because they are transparent
        Part& cornea = parts.emplace_back(makeCornea(eye));
        cornea.morphs = eyeMorphs(cornea, eye);
    }

    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return failed(fmt::format("cannot create the folder {}: {}", folder, error.message()));
    const std::pair<const char*, std::string> files[] = {{"head.glb", asGlb(parts)},
                                                         {"head_albedo.jpg", asJpeg(skin.albedo, 92)},
                                                         {"head_relief.png", asPng(skin.relief)},
                                                         {"skin_regions.png", asPng(skin.regions)},
                                                         {"head_flush.jpg", asJpeg(skin.flush, 92)},
                                                         {"eye_albedo.jpg", asJpeg(paintEye(), 92)},
                                                         {"head.json", describe(head, eyes)}};
    size_t bytes = 0;
    for (const auto& [name, content] : files) {
        if (Status written = writeFileAtomic((std::filesystem::path(folder) / name).string(), content); !written) return written.error();
        bytes += content.size();
    }
    fmt::print("make_head: {} triangles of skin, {:.2f} mm a texel on the cheeks, {} KiB in {}\n", head.triangles.size(),
               skin.cheekMillimetres, bytes / 1024, folder);
    return bytes;
}

}  // namespace
}  // namespace rivulet::head

int main(int argc, char** argv) {
    if (argc != 3) {
        fmt::print(stderr, "usage: make_head FACE.obj FOLDER (the canonical face model and the output folder)\n");
        return 2;
    }
    auto made = rivulet::head::make(argv[1], argv[2]);
    if (!made) {
        fmt::print(stderr, "make_head: {}\n", made.error().message);
        return made.error().fault == rivulet::Fault::badInput ? 2 : 1;
    }
    return 0;
}
