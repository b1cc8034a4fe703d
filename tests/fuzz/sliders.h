// Every Param that a scene's panel shows (but fluid.limits and budget), as the fuzzer drags it: found by visiting the scene, never listed
// by hand.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "engine/core/params.h"
#include "fluid/scene/scene_file.h"

namespace rivulet::fuzz {

using Random = std::mt19937_64;
double uniform(Random& random);              // [0, 1), the same on every machine
size_t below(Random& random, size_t count);  // 0 .. count - 1
bool oneIn(Random& random, size_t times);
uint64_t hashOf(std::string_view text);  // FNV-1a

// A Param with the information from its visit. Values are texts, as --set takes them.
struct Slider {
    enum class Kind { real, whole, vector, words };
    std::string path;
    Kind kind = Kind::real;
    double min = 0, max = 0, base = 0;                        // base: as it is in the scene; of a vector the longest component
    bool logarithmic = false, fixed = false, length = false;  // length: in metres
    std::vector<std::string> words;                           // of a choice, a switch or a text: all that it may be
    std::string text;                                         // as it is in the scene

    std::vector<std::string> values() const;              // both ends, the middle; of a vector each component's ends, too; of words all
    std::vector<std::string> ends() const;                // two of them
    std::string draw(Random& random, double size) const;  // any value, ends more often than others; `size`: of the scene, m

  private:
    double drawNumber(Random& random, double size) const;
    std::string number(double v) const;
};

std::vector<Slider> slidersOf(SceneFile& scene);

// All lengths in a scene (unit m) times `factor`, each kept in its range: the scene is as large in spacings as it was.
void scaleLengths(SceneFile& scene, float factor);

}  // namespace rivulet::fuzz
