from .loaded_faces import layer_fields as layer_fields
from .loaded_solid import LoadedSolid as LoadedSolid
from .solid import Solid as Solid
from .two_bodies import TwoBodies as TwoBodies
