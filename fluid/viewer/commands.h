// Commands: what a key or a button of the scene's panel makes the viewer do. The rows are also the help that H shows.
#pragma once

#include <vector>

#include "engine/app/input_events.h"
#include "engine/core/table.h"

namespace rivulet {

enum class Command {
    pause,    // or continue
    step,     // one, then pause
    restart,  // the run
    pour,     // on or off
    panels,   // shown or hidden
    help,     // shown or hidden
    scenes,   // the browser, shown or hidden
    release,  // what is chosen, and the pour brush
    undo,
    enlarge,  // the panels' text
    shrink,
    usualSize,
    save,
    find,   // a parameter
    video,  // begin or end
    picture,
    record,   // the run, to scrub through it: begin or end
    measure,  // the measurements, shown or hidden
    none,     // the mouse's: in the help alone
};

struct KeyRow {
    const char* name;  // as the help has it; "": the help does not list it
    const char* doc;
    Command command = Command::none;
    int key = 0;
    bool control = false;      // with a control key down
    bool whileTyping = false;  // also while a text field has the keyboard
};
Table<KeyRow> keys();

// Of the keys that went down since the last frame, in the order of the rows. `typing`: a text field has the keyboard.
std::vector<Command> commandsOf(const InputEvents& input, bool typing);
void drawKeyHelp();  // over the middle of the picture

}  // namespace rivulet
