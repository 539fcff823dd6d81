from typing import Any

version: str
regions: list[tuple[str, int]]
formats: list[tuple[str, str, str]]

class Error(ValueError):
    problem: str
    where: str
    remedy: str

class TetMesh:
    def __init__(self, points: Any, cells: Any, regions: Any) -> None: ...
    def __getattr__(self, name: str) -> Any: ...

def set_threads(count: int) -> None: ...
def threads() -> int: ...
def __getattr__(name: str) -> Any: ...
