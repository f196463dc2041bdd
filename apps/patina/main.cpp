// The command line of patina.
#include <cstdio>
#include <string_view>

int main(int argc, char** argv) {
    if (argc == 2 && std::string_view(argv[1]) == "--version") {
        std::puts("patina " PATINA_VERSION);
        return 0;
    }
    std::fputs("patina: command: is missing or unknown (expected --version)\n", stderr);
    return 2;
}
