"""The file that a spawner of entities is given."""

from pathlib import Path

from drake_twin.description.package_index import MissingPackageError, PackageIndex
from drake_twin.description.sdf_addresses import NotIncludedError, SdfAddresses
from drake_twin.description.source_file import file_text
from drake_twin.errors import InputError
from drake_twin.ros2.launched import LaunchedProcess


def spawned_file(file: str, process: LaunchedProcess, packages: PackageIndex) -> tuple[str, Path]:
    """Read the file that a spawner's ``-file`` names.

    ``create`` hands the name to Gazebo, which also takes a model's name or folder, and an address of Fuel;
    spawn_entity.py opens a file. A relative path starts from the working folder, as for a process of the launch; where
    nothing is there, from the launch file's.

    Args:
        file: A path, or an address.
        process: The spawner.
        packages: Resolves addresses.

    Returns:
        The text and its file.

    Raises:
        InputError: If the file does not exist or cannot be read.
    """
    is_remote = file.startswith(("http://", "https://"))
    problem = process.error(f"{file}: files are not downloaded")
    if not is_remote:
        try:
            is_here = "://" not in file and Path(file).is_file()
            path = packages.resolve(file, None if is_here else process.place.file)
            if not path.is_dir():
                return file_text(path), path
            problem = InputError("it is a folder, not a robot file", file=path)
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"cannot read the file ({error})", file=file) from None
        except InputError as error:
            problem = error
    if process.package == "gazebo_ros":
        raise problem
    address = file if "://" in file or Path(file).is_absolute() else f"model://{file}"
    try:
        text, path = SdfAddresses(packages).model_text(address, Path(process.place.file))
    except (MissingPackageError, NotIncludedError):
        raise problem from None
    if not path.is_file():  # a model that the twin itself has, such as a ground plane
        raise problem
    return text, path
