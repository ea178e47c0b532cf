# SPDX-License-Identifier: MIT
"""Write an SBOM (CycloneDX 1.6) beside each wheel and Debian package of a release.

sbom.py VERSION FOLDER
"""

import hashlib
import json
import os
import re
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path
from uuid import NAMESPACE_URL, uuid5
from zipfile import ZipFile

from cyclonedx.model import HashAlgorithm, HashType
from cyclonedx.model.bom import Bom
from cyclonedx.model.component import Component, ComponentType
from cyclonedx.model.license import DisjunctiveLicense
from cyclonedx.output.json import JsonV1Dot6
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator
from packageurl import PackageURL

# Inside of roburoc4-tools.
UPLOT = (
    Path(__file__).parents[1]
    / "tools/src/roburoc4_tools/dashboard/static/vendor/uplot/version.json"
)


def uplot() -> PackageURL:
    """Return the plots of the dashboard, which are copied."""
    return PackageURL("npm", None, "uplot", json.loads(UPLOT.read_text("utf-8"))["version"])


def wheel_needs(wheel: Path) -> list[PackageURL]:
    """Return what METADATA requires without an extra."""
    with ZipFile(wheel) as archive:
        name = next(n for n in archive.namelist() if n.endswith(".dist-info/METADATA"))
        metadata = archive.read(name).decode()
    required = re.findall(r"^Requires-Dist: ([\w-]+)(?!.*extra ==)", metadata, re.MULTILINE)
    copied = [uplot()] if wheel.name.startswith("roburoc4_tools-") else []
    return [*copied, *(PackageURL("pypi", None, package) for package in required)]


def debian_field(package: Path, field: str) -> str:
    """Return a field of the package's control file."""
    command = ["dpkg-deb", "--field", str(package), field]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def debian_needs(package: Path) -> list[PackageURL]:
    """Return what the package depends on; of alternatives, the first."""
    depends = debian_field(package, "Depends").split(",")
    names = [re.split(r"[ (|:]", field.strip())[0] for field in depends]
    needs = [PackageURL("deb", "debian", name) for name in names if name]
    return [*needs, *([uplot()] if package.name.startswith("roburoc4-tools_") else [])]


def write(file: Path, purl: PackageURL, needs: list[PackageURL]) -> None:
    """Write FILE.cdx.json: the package, its hash, its licence, and what it needs."""
    content = file.read_bytes()
    package = Component(
        name=purl.name,
        version=purl.version,
        type=ComponentType.LIBRARY,
        purl=purl,
        bom_ref=file.name,
        licenses=[DisjunctiveLicense(id="MIT")],
        hashes=[HashType(alg=HashAlgorithm.SHA_256, content=hashlib.sha256(content).hexdigest())],
    )
    bom = Bom(
        serial_number=uuid5(NAMESPACE_URL, hashlib.sha256(content).hexdigest()),
    )
    bom.metadata.timestamp = datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), UTC)
    bom.metadata.component = package
    components = [
        Component(
            name=need.name,
            version=need.version,
            type=ComponentType.LIBRARY,
            purl=need,
            bom_ref=str(need),
        )
        for need in dict.fromkeys(needs)
    ]
    for component in components:
        bom.components.add(component)
    bom.register_dependency(package, components)
    text = JsonV1Dot6(bom).output_as_string(indent=2)
    wrong = JsonStrictValidator(SchemaVersion.V1_6).validate_str(text)
    if wrong:
        sys.exit(f"{file.name}: {wrong}")
    Path(f"{file}.cdx.json").write_text(text + "\n", "utf-8")
    print(f"{file.name}.cdx.json: valid, {len(components)} dependencies")


def main() -> None:
    """Write all of them."""
    version, folder = sys.argv[1], Path(sys.argv[2])
    for wheel in sorted(folder.glob("python/*.whl")):
        name = wheel.name.partition("-")[0].replace("_", "-")
        write(wheel, PackageURL("pypi", None, name, version), wheel_needs(wheel))
    for package in sorted(folder.glob("debian/*.deb")):
        name, full_version, arch = (
            debian_field(package, field) for field in ("Package", "Version", "Architecture")
        )
        purl = PackageURL("deb", "debian", name, full_version, {"arch": arch})
        write(package, purl, debian_needs(package))


if __name__ == "__main__":
    main()
