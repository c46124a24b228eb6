"""Solutions that share nothing with the solver: closed forms and independent numerical models.

Conventions are those of `asperity.spectral` and `asperity.elasticity.layer`: z up, depth downwards from the
surface, tension positive, contact pressure and downward displacement positive, stresses per unit of
whatever the modulus is given in.
"""
