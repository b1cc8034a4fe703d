#!/usr/bin/env python3
"""What xdotool lacks, through libX11 alone: x.py drop WINDOW X Y FILE drops a file as a file manager does (XDND, version 5);
x.py look X Y W H prints a number that is the same only where the same is to be seen on the screen."""
import ctypes
import os
import sys
import time
import zlib

x11 = ctypes.CDLL("libX11.so.6")
long, ulong = ctypes.c_long, ctypes.c_ulong


class Any(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ulong), ("sent", ctypes.c_int), ("display", ctypes.c_void_p), ("window", ulong)]


class Message(ctypes.Structure):
    _fields_ = Any._fields_ + [("message", ulong), ("format", ctypes.c_int), ("l", long * 5)]


class Request(ctypes.Structure):
    _fields_ = Any._fields_[:4] + [(n, ulong) for n in ("owner", "requestor", "selection", "target", "property", "time")]


class Notify(ctypes.Structure):
    _fields_ = Any._fields_[:4] + [(n, ulong) for n in ("requestor", "selection", "target", "property", "time")]


class Event(ctypes.Union):
    _fields_ = [("type", ctypes.c_int), ("message", Message), ("request", Request), ("notify", Notify), ("room", long * 24)]


class Image(ctypes.Structure):
    _fields_ = [("width", ctypes.c_int), ("height", ctypes.c_int), ("xoffset", ctypes.c_int), ("format", ctypes.c_int),
                ("data", ctypes.POINTER(ctypes.c_ubyte)), ("order", ctypes.c_int), ("unit", ctypes.c_int), ("bits", ctypes.c_int),
                ("pad", ctypes.c_int), ("depth", ctypes.c_int), ("line", ctypes.c_int)]


def function(name, result, *arguments):
    f = getattr(x11, name)
    f.restype, f.argtypes = result, arguments
    return f


pointer, integer = ctypes.c_void_p, ctypes.c_int
openDisplay = function("XOpenDisplay", pointer, ctypes.c_char_p)
rootOf = function("XDefaultRootWindow", ulong, pointer)
internAtom = function("XInternAtom", ulong, pointer, ctypes.c_char_p, integer)
createWindow = function("XCreateSimpleWindow", ulong, pointer, ulong, integer, integer, integer, integer, integer, ulong, ulong)
setOwner = function("XSetSelectionOwner", integer, pointer, ulong, ulong, ulong)
sendEvent = function("XSendEvent", integer, pointer, ulong, integer, long, ctypes.POINTER(Event))
changeProperty = function("XChangeProperty", integer, pointer, ulong, ulong, ulong, integer, integer, ctypes.c_char_p, integer)
pending = function("XPending", integer, pointer)
nextEvent = function("XNextEvent", integer, pointer, ctypes.POINTER(Event))
flush = function("XFlush", integer, pointer)
getImage = function("XGetImage", ctypes.POINTER(Image), pointer, ulong, integer, integer, integer, integer, ulong, integer)

display = openDisplay(None)
if not display:
    sys.exit("no display")
root = rootOf(display)


def look(x, y, width, height):
    kAllPlanes, kZPixmap = 2**64 - 1, 2
    image = getImage(display, root, x, y, width, height, kAllPlanes, kZPixmap).contents
    print(zlib.crc32(bytes(image.data[:image.line * image.height])))


def drop(window, x, y, path):
    kClientMessage, kSelectionRequest, kSelectionNotify, kReplace = 33, 30, 31, 0
    atom = lambda name: internAtom(display, name.encode(), False)
    source = createWindow(display, root, 0, 0, 1, 1, 0, 0, 0)
    selection, uris = atom("XdndSelection"), atom("text/uri-list")
    setOwner(display, selection, source, 0)

    def say(what, *words):
        event = Event()
        m = event.message
        m.type, m.window, m.message, m.format = kClientMessage, window, atom(what), 32
        m.l = (long * 5)(source, *words, *[0] * (4 - len(words)))
        sendEvent(display, window, False, 0, ctypes.byref(event))
        flush(display)

    say("XdndEnter", 5 << 24, uris)
    say("XdndPosition", 0, x << 16 | y, 0, atom("XdndActionCopy"))
    end = time.time() + 60
    while time.time() < end:
        if not pending(display):
            time.sleep(0.01)
            continue
        event = Event()
        nextEvent(display, ctypes.byref(event))
        if event.type == kClientMessage and event.message.message == atom("XdndStatus"):
            if not event.message.l[1] & 1:
                sys.exit("it is not wanted there")
            say("XdndDrop", 0, 0)
        elif event.type == kClientMessage and event.message.message == atom("XdndFinished"):
            return
        elif event.type == kSelectionRequest:
            text = ("file://" + os.path.abspath(path) + "\r\n").encode()
            r = event.request
            changeProperty(display, r.requestor, r.property, uris, 8, kReplace, text, len(text))
            answer = Event()
            n = answer.notify
            n.type, n.requestor, n.selection, n.target, n.property, n.time = (kSelectionNotify, r.requestor, r.selection, r.target,
                                                                             r.property, r.time)
            sendEvent(display, r.requestor, False, 0, ctypes.byref(answer))
            flush(display)
    sys.exit("it was never taken")


if sys.argv[1] == "look":
    look(*map(int, sys.argv[2:6]))
else:
    drop(int(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]), sys.argv[5])
