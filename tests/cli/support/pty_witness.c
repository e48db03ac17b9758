/// The far end of a serial line that only listens: what the program under test wrote to an adapter.
///
/// Usage: pty_witness LINK FILE
/// LINK becomes a symbolic link to a pseudo-terminal that everybody may open; what is written to it
/// is appended to FILE. Ends after five minutes at the latest.
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

int main(int argc, char **argv) {
    const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
    if (argc != 3 || terminal < 0 || grantpt(terminal) != 0 || unlockpt(terminal) != 0) {
        perror("pty_witness");
        return 2;
    }
    const char *line = ptsname(terminal);
    const int kept = open(line, O_RDWR | O_NOCTTY); // or reading fails whenever nobody has it open
    const int out = open(argv[2], O_WRONLY | O_CREAT | O_APPEND, 0644);
    struct termios raw;
    if (kept < 0 || out < 0 || tcgetattr(kept, &raw) != 0) {
        perror("pty_witness");
        return 2;
    }
    cfmakeraw(&raw);
    if (tcsetattr(kept, TCSANOW, &raw) != 0 || chmod(line, 0666) != 0 ||
        symlink(line, argv[1]) != 0) {
        perror("pty_witness");
        return 2;
    }
    alarm(300);
    char bytes[4096];
    ssize_t count;
    while ((count = read(terminal, bytes, sizeof bytes)) > 0 &&
           write(out, bytes, (size_t)count) == count) {
    }
    return 0;
}
