/* SPDX-License-Identifier: MIT
 *
 * sim_process.h - runs the program roburoc4-sim as a child process: its lines, its signals and its
 * exit status. The program is the one of the environment variable ROBUROC4_SIM_PROGRAM, else the
 * one in the test program's own folder.
 */
#ifndef ROBUROC4_TESTS_SIM_PROCESS_H
#define ROBUROC4_TESTS_SIM_PROCESS_H

#include "udp_support.h"

#include <sys/wait.h>

#include <csignal>
#include <cstdlib>
#include <string>

namespace test {

/* A program in the test program's own folder. */
inline std::string beside_this_program(const std::string &name) {
    char own[4096];
    ssize_t length = readlink("/proc/self/exe", own, sizeof own);
    std::string path(own, length > 0 ? static_cast<size_t>(length) : 0);
    return path.substr(0, path.rfind('/') + 1) + name;
}

inline std::string sim_program() {
    const char *chosen = std::getenv("ROBUROC4_SIM_PROGRAM");
    return chosen != nullptr ? chosen : beside_this_program("roburoc4-sim");
}

class SimProcess {
  public:
    explicit SimProcess(std::vector<std::string> arguments) {
        int in[2], out[2], error[2];
        if (pipe(in) != 0 || pipe(out) != 0 || pipe(error) != 0) {
            throw std::runtime_error("no pipe");
        }
        arguments.insert(arguments.begin(), sim_program());
        pid_ = fork();
        if (pid_ == 0) {
            std::vector<char *> pointers;
            for (std::string &argument : arguments) {
                pointers.push_back(argument.data());
            }
            pointers.push_back(nullptr);
            dup2(in[0], 0);
            dup2(out[1], 1);
            dup2(error[1], 2);
            for (int fd : {in[0], in[1], out[0], out[1], error[0], error[1]}) {
                close(fd);
            }
            execv(pointers[0], pointers.data());
            _exit(127);
        }
        for (int fd : {in[0], out[1], error[1]}) {
            close(fd);
        }
        in_ = in[1];
        out_ = out[0];
        error_ = error[0];
        for (int fd : {in_, out_, error_}) {
            fcntl(fd, F_SETFD, FD_CLOEXEC);
        }
    }
    SimProcess(const SimProcess &) = delete;
    SimProcess &operator=(const SimProcess &) = delete;
    ~SimProcess() {
        if (status_ == kRunning) {
            signal(SIGKILL);
            exit_status();
        }
        end_input();
        close(out_);
        close(error_);
    }

    /* The next line of its standard output, without its end; "" if none arrives. */
    std::string line() {
        std::string text;
        char byte;
        pollfd watched{out_, POLLIN, 0};
        while (poll(&watched, 1, static_cast<int>(kPatienceUs / 1000)) > 0 &&
               read(out_, &byte, 1) == 1 && byte != '\n') {
            text += byte;
        }
        return text;
    }
    /* All of its standard error until it ends. */
    std::string errors() {
        return rest_of(error_);
    }
    std::string output() {
        return rest_of(out_);
    }
    /* The ports in the line that reports that it is ready. */
    std::vector<uint16_t> ports() {
        std::vector<uint16_t> found;
        std::string ready = line();
        if (ready.rfind("roburoc4-sim: ready on ", 0) == 0) {
            for (size_t at = ready.find(':', 13); at != std::string::npos;
                 at = ready.find(':', at + 1)) {
                found.push_back(static_cast<uint16_t>(std::stoul(ready.substr(at + 1))));
            }
        }
        return found;
    }
    /* Sends a line to its panel and returns the answer. */
    std::string panel(const std::string &text) {
        std::string line_end = text + "\n";
        if (write(in_, line_end.data(), line_end.size()) < 0) {
            return "";
        }
        return line();
    }
    void end_input() {
        if (in_ >= 0) {
            close(in_);
        }
        in_ = -1;
    }
    void signal(int number) const {
        kill(pid_, number);
    }
    /* Its exit status; 1000 and the signal where one killed it; -1 where it does not end in time.
     */
    int exit_status() {
        int status = 0;
        if (status_ == kRunning && eventually([&] {
                usleep(1000);
                return waitpid(pid_, &status, WNOHANG) == pid_;
            })) {
            status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
        }
        return status_;
    }

  private:
    static constexpr int kRunning = -1;

    static std::string rest_of(int fd) {
        std::string text;
        char bytes[512];
        ssize_t got;
        while ((got = read(fd, bytes, sizeof bytes)) > 0) {
            text.append(bytes, static_cast<size_t>(got));
        }
        return text;
    }

    pid_t pid_ = -1;
    int in_ = -1, out_ = -1, error_ = -1;
    int status_ = kRunning;
};

} // namespace test

#endif
