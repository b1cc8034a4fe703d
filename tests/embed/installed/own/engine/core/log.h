/* A header of the host, found before any of Rivulet's: its name is one of ours, its content is not. */
#ifndef HOST_LOG_H
#define HOST_LOG_H
#define HOST_LOG "the host's log"
#endif
