# SPDX-License-Identifier: MIT
#
# Until the archive has an address, it is next to this file. Homebrew installs only from a tap:
#   brew tap-new local/roburoc4
#   cp roburoc4.rb roburoc4-source-@VERSION@.tar.gz "$(brew --repository local/roburoc4)/Formula/"
#   brew install local/roburoc4/roburoc4
class Roburoc4 < Formula
  desc "Client library and simulator for the RobuROC4 mobile robot"
  homepage "https://example.org"
  url "file://#{__dir__}/roburoc4-source-@VERSION@.tar.gz"
  sha256 "@SHA256@"
  license "MIT"

  depends_on "cmake" => :build

  def install
    system "cmake", "-S", ".", "-B", "build", "-DBUILD_SHARED_LIBS=ON", "-DROBUROC4_EXAMPLES=OFF",
           "-DROBUROC4_MATLAB=OFF", "-DROBUROC4_WITH_LCM=OFF", *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    system bin/"roburoc4-sim", "--version"
    (testpath/"version.c").write <<~C
      #include <roburoc4.h>
      int main(void) { return roburoc4_version() != ROBUROC4_VERSION; }
    C
    system ENV.cc, "version.c", "-I#{include}", "-L#{lib}", "-lroburoc4", "-o", "version"
    system "./version"
  end
end
