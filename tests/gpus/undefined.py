"""What OpenGL leaves undefined and a driver may forgive, found in the SPIR-V of a shader as glslang makes it, without optimisation.

check(path, stage) returns sentences:
- derivatives, also those of texture(), in control flow that is not uniform; barriers there;
- outputs that some path does not write; local variables that some path reads before it writes them;
- more storage buffers than OpenGL guarantees: 8 in a kernel and a fragment shader, on bindings 0 to 7, and none in a vertex shader.

Uniform is what depends on uniforms, constants, read-only buffers at uniform indices and the number of the work group only. Control flow is uniform
where no other value decides whether a block runs. Each function is looked at once, as the worst of its calls has it. Of arrays it is only known whether
a function writes them at all."""
import collections
import struct

INPUT, UNIFORM, OUTPUT, WORKGROUP, PRIVATE, FUNCTION, STORAGE = 1, 2, 3, 4, 6, 7, 12
LOADS, STORES, CHAINS = {61}, {62}, {65, 66}
DERIVATIVES = {*range(207, 216), 87, 89, 91, 93, 105}
ATOMICS = set(range(227, 243))
KILL, RETURN, RETURN_VALUE, UNREACHABLE, BRANCH, CONDITIONAL, SWITCH = 252, 253, 254, 255, 249, 250, 251
UNIFORM_BUILTINS = {24, 25, 26}
# Instructions that have a result, and no type before it.
NO_TYPE = set(range(19, 40)) | {248, 5, 11, 7}


class Block:
    def __init__(self, label):
        self.label, self.code, self.next = label, [], []


class Function:
    def __init__(self, result):
        self.result, self.parameters, self.blocks, self.order = result, [], {}, []


class Module:
    """A shader's functions and what its ids are."""

    def __init__(self, words):
        self.names, self.decorations, self.members = {}, collections.defaultdict(dict), collections.defaultdict(dict)
        self.types, self.constants, self.variables, self.functions = {}, {}, {}, {}
        self.type_of = {}
        at, function, block = 5, None, None
        while at < len(words):
            op, count = words[at] & 0xFFFF, words[at] >> 16
            a = words[at + 1:at + count]
            at += count
            if op == 5:
                self.names[a[0]] = struct.pack(f"<{len(a) - 1}I", *a[1:]).split(b"\0")[0].decode()
            elif op == 15:
                self.entry = a[1]
            elif op == 71:
                self.decorations[a[0]][a[1]] = a[2] if len(a) > 2 else 1
            elif op == 72:
                self.members[a[0]].setdefault(a[1], {})[a[2]] = a[3] if len(a) > 3 else 1
            elif 19 <= op <= 33:
                self.types[a[0]] = (op, *a[1:])
            elif op in (41, 42, 43, 44, 46, 48, 49, 50, 51, 52):
                self.constants[a[1]], self.type_of[a[1]] = a[2] if op == 43 else None, a[0]
            elif op == 59 and function is None:
                self.variables[a[1]], self.type_of[a[1]] = (a[2], len(a) > 3), a[0]
            elif op == 54:
                function = self.functions[a[1]] = Function(a[1])
            elif op == 55:
                function.parameters.append(a[1])
                self.type_of[a[1]] = a[0]
            elif op == 56:
                function = None
            elif op == 248:
                block = function.blocks[a[0]] = Block(a[0])
                function.order.append(block)
            elif function is not None and op not in (8, 317):
                block.code.append((op, a))
                if op == BRANCH:
                    block.next = [a[0]]
                elif op == CONDITIONAL:
                    block.next = [a[1], a[2]]
                elif op == SWITCH:
                    block.next = [a[1], *a[3::2]]
                elif op not in NO_TYPE and len(a) > 1:
                    self.type_of.setdefault(a[1], a[0])

    def is_array(self, pointer):
        return self.types[self.types[self.type_of[pointer]][2]][0] in (28, 29)

    def parts(self, pointer):
        """How many members or components the type behind a pointer has; 0: it has none, or is an array."""
        kind = self.types[self.types[self.type_of[pointer]][2]]
        return kind[2] if kind[0] == 23 else len(kind) - 1 if kind[0] == 30 else 0


def result_of(op, a):
    """The id that an instruction makes, or None, and its operands."""
    if op in (62, 63, 64, 224, 225, 228, 246, 247, BRANCH, CONDITIONAL, SWITCH, KILL, RETURN, RETURN_VALUE, UNREACHABLE, 99, 218, 219, 220, 221):
        return None, a
    return (a[1], a[2:]) if len(a) > 1 else (None, a)


def postdominators(function, exits):
    """Sets of labels by label. exits: labels that may also leave the shader."""
    labels = [b.label for b in function.order]
    every = set(labels)
    after = {label: every for label in labels}
    changed = True
    while changed:
        changed = False
        for b in reversed(function.order):
            if not b.next or b.label in exits:
                new = {b.label}
            else:
                new = set.intersection(*(after[n] for n in b.next)) | {b.label}
            if new != after[b.label]:
                after[b.label], changed = new, True
    return after


class Uniformity:
    """Which values and which blocks are not uniform: the least such sets."""

    def __init__(self, module):
        self.m = module
        self.values = set()                    # ids that are not uniform; of variables: what they hold
        self.entered = set()                   # functions that some call enters where control flow is not uniform
        self.kills = set()                     # functions that may end the shader
        self.roots = {}
        for f in module.functions.values():    # the variable behind each pointer
            for b in f.order:
                for op, a in b.code:
                    if op in CHAINS:
                        self.roots[a[1]] = self.roots.get(a[2], a[2])
        self.divergent = {}
        changed = True
        while changed:
            before = (len(self.values), len(self.entered), len(self.kills), sum(map(len, self.divergent.values())))
            for f in module.functions.values():
                self.look(f)
            changed = before != (len(self.values), len(self.entered), len(self.kills), sum(map(len, self.divergent.values())))

    def root(self, pointer):
        return self.roots.get(pointer, pointer)

    def leaves(self, f):
        return {b.label for b in f.order for op, a in b.code if op == KILL or (op == 57 and a[2] in self.kills)}

    def look(self, f):
        exits = self.leaves(f)
        if exits:
            self.kills.add(f.result)
        if f.result in self.entered:
            self.divergent[f.result] = set(f.blocks)
        else:
            self.divergent.setdefault(f.result, set())
        after = postdominators(f, exits)
        deciding = {}                          # block -> the blocks that end in a branch on which it depends whether this one runs
        for b in f.order:
            ways = list(b.next) + ([None] if b.label in exits and b.next else [])
            if len(set(ways)) < 2:
                continue
            for n in b.next:
                for label in after[n]:
                    if label == b.label or label not in after[b.label]:
                        deciding.setdefault(label, set()).add(b.label)
        bad = self.divergent[f.result]
        moved = True
        while moved:
            moved = False
            for b in f.order:
                for op, a in b.code:
                    moved |= self.step(f, b, op, a)
            unlike = {b.label for b in f.order if self.branches_unlike(b, exits)}
            for label, by in deciding.items():
                if label not in bad and any(d in unlike or d in bad for d in by):
                    bad.add(label)
                    moved = True

    def branches_unlike(self, b, exits):
        op, a = b.code[-1]
        return (op in (CONDITIONAL, SWITCH) and a[0] in self.values) or (b.label in exits and bool(b.next))

    def add(self, value):
        if value is None or value in self.values:
            return False
        self.values.add(value)
        return True

    def step(self, f, b, op, a):
        here = b.label in self.divergent[f.result]
        if op in STORES:
            return self.add(self.root(a[0])) if here or a[1] in self.values or a[0] in self.values else False
        if op == 57:
            moved = False
            callee = self.m.functions[a[2]]
            for given, parameter in zip(a[3:], callee.parameters):
                if self.root(given) in self.values or given in self.values:
                    moved |= self.add(parameter)
                if parameter in self.values and self.m.types.get(self.m.type_of.get(parameter), (0,))[0] == 32:
                    moved |= self.add(self.root(given))
            if here and callee.result not in self.entered:
                self.entered.add(callee.result)
                moved = True
            return moved | (self.add(a[1]) if callee.result in self.values else False)
        if op == RETURN_VALUE:
            return self.add(f.result) if here or a[0] in self.values else False
        made, used = result_of(op, a)
        if made is None or made in self.values:
            return False
        if op in LOADS:
            return self.add(made) if self.unlike_load(used[0]) else False
        if op in ATOMICS or op in DERIVATIVES or op == 98:
            return self.add(made)
        if op == 245:
            return self.add(made) if any(v in self.values for v in used) or any(
                self.branches_unlike(f.blocks[p], ()) or p in self.divergent[f.result] for p in used[1::2]) else False
        return self.add(made) if any(v in self.values for v in used) else False

    def unlike_load(self, pointer):
        if pointer in self.values:
            return True
        root = self.root(pointer)
        if root in self.values:
            return True
        kind, _ = self.m.variables.get(root, (FUNCTION, False))
        if kind == INPUT:
            return self.m.decorations[root].get(11) not in UNIFORM_BUILTINS
        if kind == WORKGROUP:
            return True
        type_ = self.m.types[self.m.type_of[root]][2] if root in self.m.variables else 0
        while self.m.types.get(type_, (0,))[0] in (28, 29):
            type_ = self.m.types[type_][1]
        if kind == STORAGE or (kind == UNIFORM and 3 in self.m.decorations[type_]):
            return not (24 in self.m.decorations[root] or all(24 in d for d in self.m.members[type_].values()))
        return False


def keys_of(module, roots, pointer):
    """What a store to this pointer writes: (variable, part); part None: all of it."""
    root, part = pointer, None
    chain = roots.get(pointer)
    if chain is not None:
        root, first = chain
        if module.parts(root) and module.constants.get(first) is not None:
            part = module.constants[first]
    return root, part


class Writes:
    """Which variables each path has written."""

    def __init__(self, module):
        self.m, self.always, self.faults = module, {}, []
        done = set()

        def visit(f):
            if f.result in done:
                return
            done.add(f.result)
            for b in f.order:
                for op, a in b.code:
                    if op == 57:
                        visit(module.functions[a[2]])
            self.look(f)
        for f in module.functions.values():
            visit(f)

    def look(self, f):
        m, roots, own = self.m, {}, set()
        for b in f.order:
            for op, a in b.code:
                if op in CHAINS:
                    roots[a[1]] = roots.get(a[2], (a[2], a[3]))
                if op == 59 and len(a) == 3:
                    own.add(a[1])
        stored = {keys_of(m, roots, a[0])[0] for b in f.order for op, a in b.code if op in STORES or op == 63}
        given = {keys_of(m, roots, p)[0] for b in f.order for op, a in b.code if op == 57 for p in a[3:] if p in own or p in roots}
        arrays = {v for v in stored | given if m.is_array(v)}

        def put(written, pointer):
            root, part = keys_of(m, roots, pointer)
            parts = m.parts(root)
            if part is None:
                written.add(root)
            else:
                written.add((root, part))
                if all((root, k) in written for k in range(parts)):
                    written.add(root)

        def run(b, written, faults):
            for op, a in b.code:
                if op in STORES or op == 63:
                    put(written, a[0])
                elif op == 57:
                    written |= self.always[a[2]]
                    for pointer in a[3:]:
                        if pointer in own or pointer in roots:
                            put(written, pointer)
                elif op in LOADS and faults is not None:
                    root, part = keys_of(m, roots, a[2])
                    if root in own and root not in written and (part is None or (root, part) not in written):
                        if not (part is None and not m.parts(root) and any(isinstance(w, tuple) and w[0] == root for w in written)):
                            faults.add(root)
        before = collections.defaultdict(list)
        for b in f.order:
            for n in b.next:
                before[n].append(b.label)
        first = f.order[0].label
        at_end = {}
        changed = True
        while changed:
            changed = False
            for b in f.order:
                known = [at_end[p] for p in before[b.label] if p in at_end]
                if b.label != first and not known:
                    continue
                written = set(arrays) if b.label == first else set.intersection(*known)
                run(b, written, None)
                if at_end.get(b.label) != written:
                    at_end[b.label], changed = written, True
        faults = set()
        for b in f.order:
            if b.label in at_end:
                known = [at_end[p] for p in before[b.label] if p in at_end]
                run(b, set(arrays) if b.label == first else set.intersection(*known), faults)
        self.faults += [(f.result, root) for root in faults]
        ends = [at_end[b.label] for b in f.order if b.label in at_end and b.code[-1][0] in (RETURN, RETURN_VALUE)]
        shared = set.intersection(*ends) if ends else set()
        # A function that never returns writes all.
        self.always[f.result] = {w for w in shared if (w[0] if isinstance(w, tuple) else w) in m.variables} if ends else set(m.variables)


def check(path, stage):
    data = open(path, "rb").read()
    m = Module(struct.unpack(f"<{len(data) // 4}I", data))

    def name(value):
        return m.names.get(value, "").split("(")[0] or "a variable"

    faults = []
    uniform = Uniformity(m)
    for f in m.functions.values():
        for b in f.order:
            if b.label not in uniform.divergent[f.result]:
                continue
            for op, _ in b.code:
                if op in DERIVATIVES and stage == "frag":
                    faults.append(f"{name(f.result)} takes derivatives, or texture(), where control flow is not uniform")
                if op == 224:
                    faults.append(f"{name(f.result)} has a barrier where control flow is not uniform")
    writes = Writes(m)
    for f, root in writes.faults:
        faults.append(f"{name(f)} reads its local {name(root)}, which some path has not written")
    touched = set()
    for f in m.functions.values():
        chains = {}
        for b in f.order:
            for op, a in b.code:
                if op in CHAINS:
                    chains[a[1]] = chains.get(a[2], (a[2], a[3]))
                if op in STORES:
                    touched.add(keys_of(m, chains, a[0]))
    always = writes.always[m.entry]
    buffers = 0
    for variable, (kind, _) in m.variables.items():
        type_ = m.types[m.type_of[variable]][2]
        if kind == OUTPUT:
            built_in = [d.get(11) for d in m.members[type_].values()] if type_ in m.members else []
            if any(b is not None for b in built_in):  # gl_PerVertex: of its members those that are written, and the position
                for k in range(len(built_in)):
                    if ((variable, k) in touched or built_in[k] == 0) and (variable, k) not in always and variable not in always:
                        faults.append(f"some path does not write {'gl_Position' if built_in[k] == 0 else 'a member of gl_PerVertex'}")
            elif variable not in always and (11 not in m.decorations[variable] or any(v == variable for v, _ in touched)):
                faults.append(f"some path does not write the output {name(variable)}")
        while m.types.get(type_, (0,))[0] in (28, 29):
            type_ = m.types[type_][1]
        if kind == STORAGE or (kind == UNIFORM and 3 in m.decorations[type_]):
            buffers += 1
            if m.decorations[variable].get(33, 0) > 7:
                faults.append(f"{name(type_)} is the storage buffer of binding {m.decorations[variable][33]}, and OpenGL guarantees 0 to 7")
    if buffers > (0 if stage == "vert" else 8):
        faults.append(f"it has {buffers} storage buffers, and OpenGL guarantees {'none in a vertex shader' if stage == 'vert' else '8'}")
    return list(dict.fromkeys(faults))


# Faults that check() must find: the stage, a part of the sentence, the text.
PLANTED = [
    ("frag", "derivatives", "void main() {\n if (at.x > 0.5) colour = texture(map, at);\n else colour = vec4(0.0);\n}"),
    ("frag", "derivatives", "void main() {\n colour = vec4(1.0);\n if (at.x > 0.5) discard;\n colour.x = dFdx(at.y);\n}"),
    ("frag", "derivatives", "float f(float x) { if (x > 0.5) return 0.0; return fwidth(x); }\nvoid main() { colour = vec4(f(at.x)); }"),
    ("frag", "derivatives", "void main() {\n vec4 sum = vec4(0.0);\n for (int k = 0; k < int(at.x); ++k) sum += texture(map, at);\n colour = sum;\n}"),
    ("frag", "the output colour", "void main() { if (at.x > 0.5) colour = vec4(1.0); }"),
    ("frag", "gl_FragDepth", "void main() { colour = vec4(1.0); if (at.x > 0.5) gl_FragDepth = 0.5; }"),
    ("vert", "gl_Position", "void main() { if (at.x > 0.5) gl_Position = vec4(at, 0.0, 1.0); }"),
    ("frag", "its local sum", "void main() {\n float sum;\n if (at.x > 0.5) sum = 1.0;\n colour = vec4(sum);\n}"),
    ("comp", "barrier", "void main() { if (a[gl_LocalInvocationID.x] > 0.5) { memoryBarrierShared(); barrier(); } a[0] = 1.0; }"),
    ("comp", "barrier", "void main() { for (uint k = 0u; k < gl_LocalInvocationID.x; ++k) { memoryBarrierShared(); barrier(); } a[0] = 1.0; }"),
    ("comp", "barrier", "void step() { memoryBarrierShared(); barrier(); }\nvoid main() { if (gl_GlobalInvocationID.x < 9u) step(); a[0] = 1.0; }"),
    ("vert", "storage buffers", "layout(std430, binding = 0) buffer B { vec4 b[]; };\nvoid main() { gl_Position = b[gl_VertexID]; }"),
    ("comp", "binding 8", "layout(std430, binding = 8) buffer B { float b[]; };\nvoid main() { a[0] = b[0]; }"),
]
# And what is right, though it is near to a fault.
SOUND = [
    ("frag", "uniform float far;\nvoid main() {\n if (far > 0.5) colour = texture(map, at);\n else colour = vec4(dFdx(at), at);\n}"),
    ("frag", "void main() {\n float x;\n if (at.x > 0.5) x = 1.0; else x = fract(at.y);\n colour = vec4(x);\n if (x > 0.5) discard;\n}"),
    ("comp", "void main() { for (uint k = 0u; k < 3u; ++k) { a[gl_GlobalInvocationID.x] += 1.0; barrier(); } }"),
    ("vert", "void main() { gl_Position = vec4(at, 0.0, 1.0); }"),
]
BEGINS = {"frag": "in vec2 at;\nuniform sampler2D map;\nlayout(location = 0) out vec4 colour;\n", "vert": "in vec2 at;\n",
          "comp": "layout(local_size_x = 64) in;\nlayout(std430, binding = 0) buffer A { float a[]; };\n"}
